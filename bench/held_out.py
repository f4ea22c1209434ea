"""Fast against exact on held-out vertices: `held_out.py PALPATE OUT [--head SCAN] [--sites N] [--shared DIR]`.

Sweeps a head in fast mode, then presses N of its vertices in full (exact mode, other seed); compares all loads at the
vertices that the fast sweep only predicted. Prints the relative error of the travel (median, 95th percentile, worst),
the predicted error beside the true one, and CPU seconds per vertex of both modes.
"""
import argparse, json, os, resource, struct, subprocess, sys

def columns(path, names):
    b = open(path, 'rb').read(); n = struct.unpack_from('<I', b, 12)[0]
    j, data = json.loads(b[20:20 + n]), b[28 + n:]
    attributes = j['meshes'][0]['primitives'][0]['attributes']
    def column(name):
        a = j['accessors'][attributes[name]]; start = j['bufferViews'][a['bufferView']]['byteOffset']
        return struct.unpack_from(f"<{a['count']}f", data, start)
    e = j['extensions']['PALPATE_touchable_head']
    return e, {name: column(name) for name in names(e)}

def run(words):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(words, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode: sys.exit(f'{" ".join(words)}: exit {done.returncode}: {done.stderr.strip()[-300:]}')
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

def main():
    here = os.path.dirname(os.path.abspath(__file__))
    q = argparse.ArgumentParser(); q.add_argument('palpate'); q.add_argument('out')
    q.add_argument('--head', default=os.path.join(here, '../data/head.ply')); q.add_argument('--sites', default='400')
    q.add_argument('--fast', default=''); o = q.parse_args(); os.makedirs(o.out, exist_ok=True)
    fast, exact = os.path.join(o.out, 'fast.glb'), os.path.join(o.out, 'exact.glb')
    base = [o.palpate, 'sweep', o.head, '--quiet']
    cpu_fast = run(base + ['--mode', 'fast', '-o', fast] + o.fast.split())
    cpu_exact = run(base + ['--mode', 'exact', '--sites', o.sites, '--seed', '7', '-o', exact])
    names = lambda e: ['_STATUS', '_ERROR', '_METHOD'] + [f'_U_{i + 1}' for i in range(len(e['forces_n']))]
    ef, f = columns(fast, names); ee, x = columns(exact, names)
    solved, blended = ee['status_names'].index('solved'), ef['status_names'].index('blended')
    held = [v for v in range(len(f['_STATUS'])) if x['_STATUS'][v] == solved and f['_STATUS'][v] == blended]
    miss = sorted((abs(f[u][v] / x[u][v] - 1), v, u) for v in held for u in names(ee)[3:])
    rms = lambda v: (sum((f[u][v] / x[u][v] - 1) ** 2 for u in names(ee)[3:]) / (len(names(ee)) - 3)) ** 0.5
    inside = sum(rms(v) <= 2 * (f['_ERROR'][v] ** 2 - 0.02 ** 2) ** 0.5 for v in held) / max(1, len(held))
    s = ef['provenance']['sweep']
    print(f'{len(held)} held-out vertices x {len(names(ee)) - 3} loads: median {100 * miss[len(miss) // 2][0]:.2f} %, '
          f'95th percentile {100 * miss[len(miss) * 95 // 100][0]:.2f} %, worst {100 * miss[-1][0]:.1f} % '
          f'(vertex {miss[-1][1]}, {miss[-1][2]})')
    print(f'within twice the predicted error: {100 * inside:.0f} % of the vertices')
    print(f"fast: {s['sites']:.0f} pressed in full, {s.get('sites_promoted', 0):.0f} promoted, {s['points_solved']:.0f} solved, "
          f"{s['points_blended']:.0f} learned, {s['points_failed']:.0f} failed; {cpu_fast:.0f} CPU s with the stages before; exact {o.sites}: {cpu_exact:.0f} CPU s")
    for name, j in (('fast', ef), ('exact', ee)):
        print(f"{name} sweep: {j['run']['seconds']['sweep']:.0f} s wall")

main()
