"""The figures of the geometric half, head by head, with frozen settings (the program's defaults).

Parts (--parts, comma separated; all by default):
  upright  landmarks of the scans as they are: errors [mm]
  turned   --turns N copies of each scan in random poses and units; every copy has one treatment of anatomy_scans.py
           in turn. Success: nose tip and eye corners (and alae where known) within 8 mm; refused; silently wrong
  fit      share of the depth table's landmarks within 1.5 SD, skull outside the skin, least clearance,
           self-intersections, least Jacobian, mean stated SD
  ct       fitted against true skull, also without what of the true one its own bone encloses (nasal cavity, palate, base);
           depth against a constant depth over the face; calibration of the stated SD; stiffness at 2 N, estimated against
           true skull, by region
  mouth    the heads that are open between their lips with the jaw turned by 0, 12, 20 and 28 degrees: eyes and nose, chin [mm],
           and the opening that landmarks and fit find
  face     the face alone of every whole head: its landmarks [mm] and how far its skull lies from the whole head's, point by
           point [mm]; with the program bench/bench_fit beside palpate (-DPALPATE_BENCH=ON) also along the normal and in SDs
  time     read to fit on 200 000 triangles
"""
import argparse, json, math, os, subprocess, sys, time
import numpy as np
import anatomy_scans as scans

SUCCESS_MM = 8.0
TIMED_TRIANGLES = 200000
CT_CUT_MM = 10.0                                # the CT ends at the mouth
CT_DEFECT = '70,105,-240,-150,65,145'           # a hole in the frontal bone


def say(text):
    print(text, flush=True)


def palpate(o, *words, timeout=900):
    run = subprocess.run([o.palpate, *map(str, words), '--quiet'], capture_output=True, text=True, timeout=timeout)
    message = (run.stderr.strip().splitlines() or [''])[-1]
    return run.returncode, run.stdout, message


def needed(marks):
    return [n for n in marks if n == 'nose_tip' or n.startswith(('eye_', 'nose_corner'))]


def landmark_errors(o, path, marks, unit):
    """Errors [mm] by name, or the refusal's message."""
    code, out, message = palpate(o, 'landmarks', path, '--json')
    if code:
        return message or f'exit {code}'
    found = json.loads(out)
    scale = scans.MM[unit]
    errors = {n: math.dist(found['landmarks'][n]['position'], marks[n] / scale) * scale
              if n in found['landmarks'] else math.nan for n in needed(marks)}
    if abs(found['unit_mm'] - scale) > 1e-9 * scale:
        errors['unit'] = math.inf
    return errors


def upright(o):
    say(f"{'upright':10} {'tip':>5} {'alae':>5} {'eyes':>5} {'mean':>5} {'worst':>6}   [mm]")
    everything = []
    for name, path, unit, marks, _ in o.heads:
        if not marks: continue
        errors = landmark_errors(o, path, {n: np.array(p, float) * scans.MM[unit] for n, p in marks.items()}, unit)
        if isinstance(errors, str):
            say(f'{name:10} refused: {errors}')
            continue
        mean = lambda start: np.mean([e for n, e in errors.items() if n.startswith(start)] or [math.nan])
        all_of = list(errors.values())
        everything += all_of
        say(f"{name:10} {errors['nose_tip']:5.1f} {mean('nose_corner'):5.1f} {mean('eye'):5.1f} {np.mean(all_of):5.1f} {max(all_of):6.1f}")
    if everything:
        say(f"{'all':10} {'':17} {np.mean(everything):5.1f} {max(everything):6.1f}   asked: mean <= 2, worst <= 5")


def turned(o):
    say(f"{'turned':10} {'copies':>6} {'success':>7} {'refused':>7} {'wrong':>5} {'mean':>5} {'worst':>6} {'s each':>6}")
    total = np.zeros(4)
    by_kind = {k: np.zeros(3) for k in scans.TREATMENTS}
    for name, path, unit, marks, _ in o.heads:
        if not marks: continue
        index = o.place[name]  # the same copies whatever --only leaves out
        points, triangles, truth = scans.in_millimetres(path, unit, marks)
        found, counts, start = [], np.zeros(3), time.time()
        for turn in range(o.turns):
            rng = np.random.default_rng([2026, index, turn])
            kind = scans.TREATMENTS[turn % len(scans.TREATMENTS)]
            p, t, m = scans.treat(kind, points, triangles, truth, rng)
            r, shift = scans.rotation(rng), rng.normal(size=3) * 50
            to = list(scans.MM)[rng.integers(len(scans.MM))]
            copy = os.path.join(o.out, 'turned.ply')
            scans.write_ply(copy, (p @ r.T + shift) / scans.MM[to], t)
            errors = landmark_errors(o, copy, {n: r @ x + shift for n, x in m.items()}, to)
            if isinstance(errors, str): verdict = 1
            else:
                worst = max(math.inf if math.isnan(e) else e for e in errors.values())
                verdict = 0 if worst <= SUCCESS_MM else 2
                if verdict == 0: found += errors.values()
            counts[verdict] += 1
            by_kind[kind][verdict] += 1
            if verdict: say(f'  {name} {turn} ({kind}, {to}): ' + (errors if verdict == 1 else f'worst {worst:.1f} mm'))
        total += [o.turns, *counts]
        say(f'{name:10} {o.turns:6} {counts[0]:7.0f} {counts[1]:7.0f} {counts[2]:5.0f} {np.mean(found or [math.nan]):5.1f} '
            f'{max(found or [math.nan]):6.1f} {(time.time() - start) / o.turns:6.1f}')
    for kind, c in by_kind.items(): say(f'  {kind:10} success {c[0]:.0f} refused {c[1]:.0f} wrong {c[2]:.0f}')
    say(f"{'all':10} {total[0]:6.0f} {total[1]:7.0f} {total[2]:7.0f} {total[3]:5.0f}   success {100 * total[1] / max(1, total[0]):.1f} %"
        '   asked: >= 99 %, none wrong')


def fit(o):
    say(f"{'fit':10} {'in1.5sd':>7} {'outside':>7} {'clear':>6} {'selfint':>7} {'jacobian':>8} {'mean SD':>7} {'s':>5}")
    for name, path, unit, _, true_skull in o.heads:
        start = time.time()
        code, out, message = palpate(o, 'fit', path, '-o', os.path.join(o.out, name + '.skull.ply'), '--json')
        if code:
            say(f'{name:10} refused: {message}')
            continue
        f = json.loads(out)
        rows = [d for d in f['depths'] if d['reached'] and d['sd_mm']]
        share = np.mean([abs(d['depth_mm'] - d['published_mm']) <= 1.5 * d['sd_mm'] for d in rows])
        s = f['fit']
        say(f"{name:10} {share:7.2f} {s['outside_count']:7.0f} {s['min_clearance_mm']:6.2f} {s['self_intersections']:7.0f} "
            f"{s['least_jacobian']:8.2f} {s.get('spread_mean_mm', math.nan):7.2f} {time.time() - start:5.0f}")
    say('asked: 0.75 to 0.95 within 1.5 SD; nothing outside, no self-intersections, no flips (Jacobian > 0)')


def ct(o):
    for name, path, unit, _, true_skull in o.heads:
        if not true_skull: continue
        script = os.path.join(o.shared, 'tools/skull_error.py')
        fitted = os.path.join(o.out, name + '.skull.ply')
        if not os.path.exists(fitted): palpate(o, 'fit', path, '-o', fitted)
        measured = lambda true: subprocess.run([sys.executable, script, fitted, true, path, '--up', '+z', '--cut',
                                                str(CT_CUT_MM), '--exclude', CT_DEFECT], capture_output=True, text=True).stdout.strip()
        say(f'{name} skull: {measured(true_skull)}   asked: mean <= 2.2, p95 <= 7')
        points, triangles = scans.read_ply(true_skull)
        outer = os.path.join(o.out, name + '.outer.ply')
        hidden = scans.enclosed(points)
        scans.write_ply(outer, points, triangles[~hidden[triangles].all(axis=1)])
        say(f'{name} skull, its outer surface alone ({100 * hidden.mean():.0f} % of its points are enclosed): {measured(outer).split("; ")[1]}')
        heads = [os.path.join(o.out, f'{name}.{kind}.glb') for kind in ('estimated', 'true')]
        for head, extra in zip(heads, ([], ['--skull', true_skull])):
            code, _, message = palpate(o, 'build', path, '-o', head, '--no-report', '--no-tissue', *extra, timeout=3600)
            if code: return say(f'{name} {extra}: {message}')
        low = scans.in_millimetres(true_skull, unit, {})[0][:, 2].min() + CT_CUT_MM
        code, out, message = palpate(o, 'compare', *heads, '--leave-out', CT_DEFECT, '--leave-out',
                                     f'-1e4,1e4,-1e4,1e4,-1e4,{low}', '--html', os.path.join(o.out, name + '.compare.html'), '--json')
        if code: return say(f'{name} compare: {message}')
        c = json.loads(out)
        for row in c['regions']:
            say(f"  {row['region']:10} n {row['vertices']:6} depth error {row['depth_error_mean_mm'] or math.nan:5.2f} mm  median bias {row['depth_bias_median_mm'] or math.nan:6.2f}  "
                f"stiffness error {100 * (row['stiffness_error_median'] or math.nan):5.1f} %")
        d = c['depth']
        say(f"{name} depth over the face: {d['face_error_mean_mm']:.2f} mm against {d['face_constant_error_mean_mm']:.2f} mm of the best constant: "
            f"{100 * (1 - d['face_error_mean_mm'] / d['face_constant_error_mean_mm']):.0f} % smaller   asked: 30 %")
        if d.get('within_2_sd') is not None:
            say(f"{name} calibration: {100 * d['within_2_sd']:.1f} % within 2 SD, mean SD {d['sd_mean_mm']:.2f} mm   asked: 90 to 99 %, <= 3.5")
        say(f"{name} stiffness at 2 N: median error {100 * c['stiffness']['error_median']:.1f} %   asked: <= 15 %")


def mouth(o):
    for name, path, unit, marks, _ in o.heads:
        if not marks: continue
        points, triangles, truth = scans.in_millimetres(path, unit, marks)
        for degrees in (0, 12, 20, 28):
            opened = scans.open_mouth(points, triangles, truth, degrees)
            if not opened: break
            file = os.path.join(o.out, f'{name}.open{degrees}.ply')
            scans.write_ply(file, opened[0], triangles)
            code, out, message = palpate(o, 'landmarks', file, '--json', '--unit', 'mm')
            if code:
                say(f'{name:10} {degrees:3} degrees refused: {message}')
                continue
            found = json.loads(out)
            at = {n: p['position'] for n, p in found['landmarks'].items()}
            worst = max(math.dist(at[n], truth[n]) for n in needed(truth))
            chin = f"{math.dist(at['chin'], opened[1]):.1f}" if 'chin' in at else 'none'
            code, out, message = palpate(o, 'fit', file, '-o', file.replace('.ply', '.skull.ply'), '--json', '--unit', 'mm')
            s = json.loads(out)['fit'] if not code else {}
            say(f"{name:10} {degrees:3} degrees: eyes and nose {worst:.1f} mm, chin {chin} mm; jaw fitted at {s.get('jaw_opening_deg', math.nan):.1f} "
                f"(SD {s.get('jaw_opening_sd_deg', math.nan):.1f}) degrees, outside {s.get('outside_count', math.nan):.0f}, "
                f"self-intersections {s.get('self_intersections', math.nan):.0f}" + ''.join('; warned' for w in found['warnings'] if 'chin' in w))


def face(o):
    for name, path, unit, marks, _ in o.heads:
        if not marks: continue
        points, triangles, truth = scans.in_millimetres(path, unit, marks)
        part = scans.face_alone(points, triangles, truth)
        if len(part[1]) > 0.75 * len(triangles): continue  # no whole head
        files = {kind: os.path.join(o.out, f'{name}.{kind}.ply') for kind in ('whole', 'face')}
        scans.write_ply(files['whole'], points, triangles)
        scans.write_ply(files['face'], *part)
        errors = landmark_errors(o, files['face'], truth, 'mm')
        if isinstance(errors, str):
            say(f'{name:10} refused: {errors}')
            continue
        skulls = {}
        for kind, file in files.items():
            out = file.replace('.ply', '.skull.ply')
            code, _, message = palpate(o, 'fit', file, '-o', out, '--unit', 'mm')
            if code: return say(f'{name} {kind}: {message}')
            skulls[kind] = scans.read_ply(out)[0]
        text = ''
        if len(skulls['whole']) == len(skulls['face']):
            apart = np.linalg.norm(skulls['whole'] - skulls['face'], axis=1)
            text = f'bone {apart.mean():.1f} mm from that of the whole head, 95th percentile {np.quantile(apart, 0.95):.1f}'
        say(f'{name:10} landmarks {np.mean(list(errors.values())):.1f} mean, {max(errors.values()):.1f} worst; {text}')
        bench = os.path.join(os.path.dirname(os.path.abspath(o.palpate)), 'bench/bench_fit')
        if not os.path.exists(bench): continue
        run = subprocess.run([bench, files['face'], '--skull', files['whole'].replace('.ply', '.skull.ply')],
                             capture_output=True, text=True)
        for line in run.stdout.splitlines():
            if line.startswith(('  bone:', '  all:')): say(' ' * 10 + line)


def timing(o):
    name, path, unit, marks, _ = o.heads[0]
    points, triangles = scans.read_ply(path)
    while 4 * len(triangles) <= TIMED_TRIANGLES: points, triangles = halved(points, triangles)
    points, triangles = thirds(points, triangles, TIMED_TRIANGLES)
    big = os.path.join(o.out, 'big.ply')
    scans.write_ply(big, points, triangles)
    before = os.times()
    start = time.time()
    code, out, message = palpate(o, 'fit', big, '-o', os.path.join(o.out, 'big.skull.ply'), '--json')
    after = os.times()
    cpu = after.children_user + after.children_system - before.children_user - before.children_system
    say(f'time: {len(triangles)} triangles, read to fit {time.time() - start:.1f} s ({cpu:.1f} s of processor)   asked: <= 20 s on two cores'
        if not code else f'time: {message}')


def halved(points, triangles):
    """Every edge halved: four triangles for one."""
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    unique, back = np.unique(edges, axis=0, return_inverse=True)
    middle = (points[unique[:, 0]] + points[unique[:, 1]]) / 2
    ab, bc, ca = (back.reshape(3, -1) + len(points))
    a, b, c = triangles.T
    fine = np.concatenate([np.stack(x, 1) for x in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))])
    return np.concatenate([points, middle]), fine


def thirds(points, triangles, wanted):
    """Some triangles cut in three at their middle, so that there are `wanted` (three times as many at most)."""
    cut, rest = np.split(triangles, [min(len(triangles), max(0, wanted - len(triangles)) // 2)])
    middle = points[cut].mean(axis=1)
    m = np.arange(len(cut)) + len(points)
    a, b, c = cut.T
    fine = np.concatenate([np.stack(x, 1) for x in ((a, b, m), (b, c, m), (c, a, m))])
    return np.concatenate([points, middle]), np.concatenate([fine, rest])


def main():
    q = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    q.add_argument('palpate'); q.add_argument('out')
    q.add_argument('--shared', default=os.environ.get('PALPATE_SHARED', os.path.join(scans.HERE, '../../shared')))
    q.add_argument('--turns', type=int, default=20); q.add_argument('--only'); q.add_argument('--parts')
    o = q.parse_args()
    os.makedirs(o.out, exist_ok=True)
    all_heads = list(scans.heads(o.shared))
    o.place = {h[0]: i for i, h in enumerate(all_heads)}
    o.heads = [h for h in all_heads if not o.only or h[0] in o.only.split(',')]
    if not any(h[4] for h in o.heads): say('no head with a true skull here (../shared/heads): its figures are left out')
    parts = {'upright': upright, 'turned': turned, 'fit': fit, 'ct': ct, 'mouth': mouth, 'face': face, 'time': timing}
    for part in o.parts.split(',') if o.parts else parts: parts[part](o)


main()
