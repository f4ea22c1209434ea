"""Every figure of the main job, head by head: `heads.py PALPATE OUT [--shared DIR] [--sites N]`.

Builds the bundled head and, where the folder of development heads is there, all of those; prints one row a head:
landmark errors against the known positions [mm], skull vertices outside the skin or closer than the clearance,
share of the depth table's landmarks within 1.5 SD, Kendall's tau against the published order, whether the cheek is
softest, blending error, unsolved vertices and wall time; then the fitted against the true skull where that is known.
"""
import argparse, json, math, os, subprocess, sys, time

HERE = os.path.dirname(os.path.abspath(__file__))
SKULL_LIMITS = ['--up', '+z', '--cut', '10', '--exclude', '70,105,-240,-150,65,145', '--mean', '3.0', '--p95', '9']
MM = {'mm': 1, 'cm': 10, 'm': 1000}

def heads(shared):
    bundled = json.load(open(os.path.join(HERE, '../data/head.json')))
    marks = {n: m['position'] if isinstance(m, dict) else m for n, m in bundled['landmarks'].items()}
    yield 'bundled', os.path.join(HERE, '../data/head.ply'), bundled.get('unit', 'mm'), marks, None
    listing = os.path.join(shared, 'heads/heads.json')
    if not os.path.exists(listing):
        print('development heads are absent: only the bundled head is measured', file=sys.stderr)
        return
    folder = os.path.dirname(listing)
    for name, m in json.load(open(listing)).items():
        if 'file' in m and 'landmarks' in m: yield name, os.path.join(folder, m['file']), m['unit'], m['landmarks'], None
        elif 'skin' in m: yield name, os.path.join(folder, m['skin']), m['unit'], {}, os.path.join(folder, m['skull'])

def errors(found, known, unit):
    return {n: math.dist(found[n]['position'], p) * MM[unit] for n, p in known.items() if n in found}

def main():
    q = argparse.ArgumentParser(); q.add_argument('palpate'); q.add_argument('out')
    q.add_argument('--shared', default=os.environ.get('PALPATE_SHARED', os.path.join(HERE, '../../shared'))); q.add_argument('--sites')
    q.add_argument('--only'); o = q.parse_args(); os.makedirs(o.out, exist_ok=True)
    print(f"{'head':10} {'tip':>5} {'eyes':>5} {'max':>5} {'outside':>7} {'clear':>6} {'in1.5sd':>7} {'tau':>5} {'cheek':>6} {'err50':>6} {'err95':>6} {'failed':>6} {'s':>5}")
    skulls = []
    for name, path, unit, known, true_skull in heads(o.shared):
        if o.only and name not in o.only.split(','): continue
        glb = os.path.join(o.out, name + '.glb'); start = time.time()
        run = subprocess.run([o.palpate, 'build', path, '-o', glb, '--json', '--quiet'] + (['--sites', o.sites] if o.sites else []), capture_output=True, text=True)
        seconds = time.time() - start
        if run.returncode:
            print(f'{name:10} exit {run.returncode}: {run.stderr.strip().splitlines()[-1] if run.stderr.strip() else "no message"}'); continue
        h = json.loads(run.stdout); e = errors(h['landmarks'], known, unit)
        eyes = [x for n, x in e.items() if n.startswith('eye')]; must = eyes + [e[n] for n in e if n.startswith('nose')]
        fit, sweep = h['provenance']['fit'], h['provenance']['sweep']; order = h['regions'].get('order', [])
        share = h['depth_agreement']['share']; tau = h['regions'].get('kendall_tau')
        num = lambda x, f: format(x, f) if x is not None else '-'
        print(f"{name:10} {num(e.get('nose_tip'), '5.1f'):>5} {num(sum(eyes) / len(eyes) if eyes else None, '5.1f'):>5} {num(max(must) if must else None, '5.1f'):>5} "
              f"{fit.get('outside_count', -1):7.0f} {fit.get('min_clearance_mm', -1):6.2f} {num(share, '7.2f'):>7} {num(tau, '5.2f'):>5} {('softest' if order and order[-1] == 'cheek' else 'no'):>6.6} "
              f"{num(sweep.get('blend_left_out_error_median'), '6.3f'):>6} {num(sweep.get('blend_left_out_error_p95'), '6.3f'):>6} {h['status']['failed']:6} {seconds:5.0f}", flush=True)
        if true_skull: skulls.append((name, glb, true_skull, path))
    script = os.path.join(o.shared, 'tools/skull_error.py')
    for name, glb, true_skull, skin in skulls:
        fitted = glb[:-4] + '.skull.ply'
        subprocess.run([o.palpate, 'export', glb, '--skull', fitted, '--quiet'], check=True, capture_output=True)
        print(f'{name} skull against the truth:', subprocess.run(['/usr/bin/python3', script, fitted, true_skull, skin] + SKULL_LIMITS, capture_output=True, text=True).stdout.strip())

main()
