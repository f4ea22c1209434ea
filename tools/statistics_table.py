#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Random data sets with the results of SciPy and R, for tests/study/statistics_table_test.cpp.

  /usr/bin/python3 tools/statistics_table.py tests/study/reference/statistics.json

SciPy (python3-scipy) computes everything but three that R (r-base-core) does: Shapiro-Wilk (SciPy
1.10 computes it in single precision), Student's quantiles of the intervals of means (there its error
reaches 1e-8) and Holm's adjustment. Where a test has an exact and an approximate form, the form is
chosen by the rule that the headers of src/study/statistics state.
"""
import json
import subprocess
import sys
import tempfile
import warnings

import numpy as np
from scipy import optimize, special, stats

SETS, FORCED_CHOICES = 1000, 60
REFERENCE = 5.0  # of the one-sample test
DEGREES = []  # of freedom, of which the quantile is needed
LAPSE, Z75 = 0.02, 0.674489750196081743
warnings.simplefilter("ignore")


def draw(rng, index):
    """a and b; the first min(na, nb) values are pairs. Kinds: ratings (many ties), half steps, normal, skewed."""
    na, nb = (int(v) for v in rng.integers(3, 31, 2))
    if index % 10 == 9:  # also beyond the limit of the exact forms
        na, nb = (int(v) for v in rng.integers(20, 71, 2))
    shift, n = rng.normal(0, 0.7), max(na, nb)
    base = rng.normal(0, 1, n)
    a, b = base + rng.normal(0, 0.7, n), base + shift + rng.normal(0, 0.9, n)
    kind = index % 4
    if kind == 0:
        a, b = (np.clip(np.round(5.5 + 2 * v), 1, 10) for v in (a, b))
    elif kind == 1:
        a, b = (np.clip(np.round(2 * (5.5 + 2 * v)) / 2, 1, 10) for v in (a, b))
    elif kind == 2:
        a, b = (np.round(5 + 2 * v, 3) for v in (a, b))
    else:
        a, b = (np.round(3 * np.exp(0.6 * v), 3) for v in (a, b))
    return a[:na], b[:nb]


def tied(values):
    return len(np.unique(values)) < len(values)


def add_interval(out, name, middle, error, df):
    """Ends as functions of Student's quantile, which R fills in."""
    out[f"{name}_low"] = lambda q: middle - q(df) * error
    out[f"{name}_high"] = lambda q: middle + q(df) * error
    DEGREES.append(df)


def results(a, b):
    n = min(len(a), len(b))
    pa, pb, d = a[:n], b[:n], a[:n] - b[:n]
    out = {"mean": a.mean(), "sd": a.std(ddof=1), "median": np.median(a), "quartile": np.quantile(a, 0.25)}
    one = stats.ttest_1samp(a, REFERENCE)
    out |= {"one_t": one.statistic, "one_p": one.pvalue}
    add_interval(out, "one", a.mean(), a.std(ddof=1) / np.sqrt(len(a)), len(a) - 1)
    welch = stats.ttest_ind(a, b, equal_var=False)
    va, vb = a.var(ddof=1) / len(a), b.var(ddof=1) / len(b)
    df = (va + vb) ** 2 / (va**2 / (len(a) - 1) + vb**2 / (len(b) - 1))
    out |= {"welch_t": welch.statistic, "welch_p": welch.pvalue, "welch_df": df}
    add_interval(out, "welch", a.mean() - b.mean(), np.sqrt(va + vb), df)
    pair = stats.ttest_rel(pa, pb)
    out |= {"pair_t": pair.statistic, "pair_p": pair.pvalue}
    add_interval(out, "pair", d.mean(), d.std(ddof=1) / np.sqrt(n), n - 1)
    exact = not tied(np.concatenate([a, b])) and max(len(a), len(b)) <= 49
    mw = stats.mannwhitneyu(a, b, method="exact" if exact else "asymptotic", use_continuity=True)
    out |= {"mw_u": mw.statistic, "mw_p": mw.pvalue, "mw_exact": int(exact)}
    nonzero = d[d != 0]
    exact = not tied(np.abs(nonzero)) and len(nonzero) <= 49
    w = stats.wilcoxon(nonzero, zero_method="wilcox", correction=True, method="exact" if exact else "approx")
    out |= {"wx_smaller": w.statistic, "wx_p": w.pvalue, "wx_exact": int(exact)}
    exact = not tied(pa) and not tied(pb) and n <= 33
    k = stats.kendalltau(pa, pb, method="exact" if exact else "asymptotic")
    out |= {"tau": k.statistic, "tau_p": k.pvalue}
    r = stats.pearsonr(pa, pb)
    ci = r.confidence_interval() if n > 3 else (None, None)
    out |= {"r": r.statistic, "r_p": r.pvalue, "r_low": ci[0], "r_high": ci[1]}
    s = stats.spearmanr(pa, pb)
    out |= {"rho": s.statistic, "rho_p": s.pvalue}
    line = stats.linregress(pa, pb)
    out |= {"intercept": line.intercept, "slope": line.slope}
    successes = int((a >= REFERENCE).sum())
    share = stats.binomtest(successes, len(a))
    wilson, cp = share.proportion_ci(method="wilson"), share.proportion_ci(method="exact")
    out |= {"wilson_low": wilson.low, "wilson_high": wilson.high, "cp_low": cp.low, "cp_high": cp.high}
    pooled = np.sqrt(((len(a) - 1) * a.var(ddof=1) + (len(b) - 1) * b.var(ddof=1)) / (len(a) + len(b) - 2))
    dof = len(a) + len(b) - 2
    cohen = (a.mean() - b.mean()) / pooled
    unbias = special.gamma(dof / 2) / (np.sqrt(dof / 2) * special.gamma((dof - 1) / 2))
    out |= {"d": cohen, "g": cohen * unbias, "dz": d.mean() / d.std(ddof=1)}
    bf = stats.levene(a, b, center="median")
    out |= {"bf_f": bf.statistic, "bf_p": bf.pvalue}
    return out


def from_r(sets, ps):
    """Per set Shapiro-Wilk of a and Holm over its p values; and the 97.5 % quantile of Student's t per df."""
    script = """
args <- commandArgs(TRUE)
rows <- function(name) lapply(strsplit(readLines(file.path(args[1], name)), " "), as.numeric)
a <- rows("a"); p <- rows("p"); df <- rows("df")[[1]]
cat(sprintf("%.17g", qt(0.975, df)), "\\n")
for (i in seq_along(a)) {
  s <- tryCatch(shapiro.test(a[[i]]), error = function(e) list(statistic = NaN, p.value = NaN))
  cat(sprintf("%.17g", c(s$statistic, s$p.value, p.adjust(p[[i]], "holm"))), "\\n")
}
"""
    with tempfile.TemporaryDirectory() as folder:
        for name, rows in (("a", [a for a, _ in sets]), ("p", ps), ("df", [DEGREES])):
            with open(f"{folder}/{name}", "w") as f:
                f.writelines(" ".join(f"{v:.17g}" for v in row) + "\n" for row in rows)
        out = subprocess.run(["Rscript", "-e", script, folder], check=True, capture_output=True, text=True).stdout
    lines = [[float(v) for v in line.split()] for line in out.splitlines()]
    quantile = dict(zip(DEGREES, lines[0]))
    return lines[1:], lambda df: quantile[df]


def forced_choice(rng):
    """A staircase (two down, one up) of an observer with a Weber fraction, and its fit by SciPy."""
    w, level, run, rows = rng.uniform(0.05, 0.3), 0.5, 0, []
    for _ in range(int(rng.integers(30, 81))):
        level = float(f"{level:.5g}")
        ok = rng.random() < LAPSE / 2 + (1 - LAPSE) * special.ndtr(Z75 * level / w)
        rows.append((level, int(ok)))
        run = run + 1 if ok else 0
        if not ok:
            level = min(1.0, level * 1.25)
        elif run == 2:
            level, run = level / 1.25, 0
    x, ok = np.array([r[0] for r in rows]), np.array([r[1] for r in rows], bool)

    def loglik(u):  # complex u: its imaginary step is the derivative, to the last digit
        arg = Z75 * x * np.exp(-u)
        right = LAPSE / 2 + (1 - LAPSE) * 0.5 * (1 + special.erf(arg / np.sqrt(2)))
        return np.sum(np.where(ok, np.log(right), np.log(1 - right)))

    u = optimize.minimize_scalar(lambda v: -loglik(v), bounds=(-6, 2), method="bounded").x
    u = optimize.brentq(lambda v: loglik(v + 1e-30j).imag, u - 0.3, u + 0.3, xtol=1e-15)
    floor = loglik(u) - stats.chi2.ppf(0.95, 1) / 2
    ends = [optimize.brentq(lambda v: loglik(v) - floor, u, far, xtol=1e-15) for far in (u - 3, u + 3)]
    return {"level": [r[0] for r in rows], "correct": [r[1] for r in rows],
            "w": np.exp(u), "low": np.exp(ends[0]), "high": np.exp(ends[1])}


def short(v):
    if isinstance(v, (int, np.integer)):
        return int(v)
    return None if v is None or not np.isfinite(v) else float(f"{v:.13g}")


def main():
    rng = np.random.default_rng(2015)
    sets = [draw(rng, i) for i in range(SETS)]
    rows = [results(a, b) for a, b in sets]
    family = ["one_p", "welch_p", "pair_p", "mw_p", "wx_p", "tau_p", "r_p"]
    ps = [[row[k] for k in family] for row in rows]
    by_r, quantile = from_r(sets, ps)
    for row, more in zip(rows, by_r):
        for name, value in row.items():
            row[name] = value(quantile) if callable(value) else value
        row["sw_w"], row["sw_p"] = more[:2]
        row |= {f"holm_{k}": v for k, v in zip(family, more[2:])}
    names = list(rows[0])
    with open(sys.argv[1], "w") as f:
        f.write('{"about": "made by tools/statistics_table.py with SciPy and R; a, b: samples; r: results",\n')
        f.write(f'"names": {json.dumps(names)},\n"sets": [\n')
        f.write(",\n".join(json.dumps({"a": list(a), "b": list(b), "r": [short(row[k]) for k in names]},
                                      separators=(",", ":")) for (a, b), row in zip(sets, rows)))
        f.write('],\n"forced_choice": [\n')
        f.write(",\n".join(json.dumps({k: (v if isinstance(v, list) else short(v)) for k, v in
                                       forced_choice(rng).items()}, separators=(",", ":"))
                           for _ in range(FORCED_CHOICES)))
        f.write("]}\n")


if __name__ == "__main__":
    main()
