# SPDX-License-Identifier: MIT
"""R computes what `tactor analyze` prints, for all studies of studies.py.

Usage: check_r.py TOOL [--write]   --write: keeps what R says in golden/, which the suite compares with, without R.
Compares R with golden/, and the tool with R: within 1e-8 max(1, |value|), Tukey's p within 1e-6. Reads the table of --format wide.
Then fits the models that --format tsv names, where lme4 is there, and counts the effects that they find where there are none. Ends with
a line that counts.
"""
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

import studies

HERE = pathlib.Path(__file__).resolve().parent
GOLDEN = HERE / "golden"


def flat(value, at=""):
    """Returns the places of all numbers and nulls in JSON."""
    if isinstance(value, dict):
        for k, v in value.items():
            yield from flat(v, f"{at}.{k}" if at else k)
    elif isinstance(value, list):
        for i, v in enumerate(value):
            yield from flat(v, f"{at}.{i}")
    else:
        yield at, value


def read(text):
    """Maps places to numbers or None, from the output of analyze.R."""
    rows = (line.split("\t") for line in text.splitlines() if not line.startswith("#"))
    return {place: None if value == "NA" else float(value) for place, value in rows}


def differences(expected, told):
    """Returns the differences; `told` is JSON."""
    mine = dict(flat(told))
    for place, value in expected.items():
        # A missing interval is null as a whole.
        got = mine.get(place, mine.get(place.rsplit(".", 1)[0], "nothing"))
        if value is None or not isinstance(got, (int, float)):
            if got != value:
                yield f"{place}: {got}, R: {value}"
            continue
        near = 1e-6 if ".tukey." in place and place.endswith(".p") else 1e-8 * max(1, abs(value))
        if not abs(got - value) <= near:
            yield f"{place}: {got}, R: {value}"


def run(*command, cwd=None):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False, cwd=cwd)
    if done.returncode:
        raise RuntimeError(f"{command[0]}: status {done.returncode}\n{done.stdout[-500:]}\n{done.stderr[-2000:]}")
    return done.stdout


def fit(tool, study, program):
    """Returns what an R program prints about the table of --format tsv."""
    (study.parent / "trials.tsv").write_text(run(tool, "analyze", study, "--format", "tsv"))
    return run("Rscript", "-e", program, cwd=study.parent)


def check(tool, name, folder, write):
    told = json.loads(run(tool, "analyze", folder / name, "--format", "json"))
    text = run("Rscript", HERE / "analyze.R", folder / name, folder / f"{name}.runs")
    if write:
        version = run("Rscript", "-e", 'cat(R.version.string, "car", as.character(packageVersion("car")))')
        (GOLDEN / f"{name}.tsv").write_text(f"# analyze.R, {version}\n{text}")
    golden = read((GOLDEN / f"{name}.tsv").read_text(encoding="utf-8"))
    r = read(text)
    assert len(r) > 100, f"R said {len(r)} numbers"
    bad = list(differences(golden, r))
    bad += [f"golden/{name}.tsv lacks {k}" for k in r.keys() - golden.keys()]
    return bad + list(differences(r, told))


COMMANDS = """
lines <- readLines("trials.tsv")
said <- sub("^# ", "", grep("^# [a-z]+(4|\\\\()|^# d <-|^# library", lines, value = TRUE))
"""
FIT = COMMANDS + """
for (line in said) suppressMessages(suppressWarnings(eval(parse(text = line))))
stopifnot(length(said) >= 5, nrow(d) == sum(!grepl("^#", lines)) - 1)
cat("fitted", length(said) - 3)
"""

# Ratings by people who differ in the effect of the methods on them, but without a common preference: how often the printed line
# finds an effect of the method all the same, and one without slopes. And ratings in which a method is better in one motion and
# worse in the others: the method's coefficient is that over all of them.
SLOPES = """
lines <- readLines("trials.tsv")
said <- sub("^# ", "", grep("^# ", lines, value = TRUE))
said <- said[!startsWith(said, "simulated")]
for (line in said[1:3]) suppressMessages(eval(parse(text = line)))
line <- grep("^lmer", said, value = TRUE)[1]
rated <- d[!is.na(d$rating), ]
people <- unique(rated$participant); motions <- sort(unique(rated$motion))
sign <- ifelse(rated$method == sort(unique(rated$method))[1], 0.5, -0.5)
who <- match(rated$participant, people)
model <- function(line, rating) {
  made <- rated
  made$rating <- rating
  d <<- made
  coef(summary(suppressMessages(suppressWarnings(eval(parse(text = line))))))
}
found <- function(line, rating) {
  t <- model(line, rating)["method1", "t value"]
  2 * pt(-abs(t), length(people) - 1) < 0.05
}
set.seed(20261125)
times <- 100
hits <- c(0, 0)
flat <- sub("(1 + method | participant)", "(1 | participant)", line, fixed = TRUE)
stopifnot(flat != line)
for (i in 1:times) {
  rating <- 3 + rnorm(length(people), 0, 0.5)[who] + sign * rnorm(length(people), 0, 0.8)[who] + rnorm(nrow(rated), 0, 0.8)
  hits <- hits + c(found(line, rating), found(flat, rating))
}
crossed <- 3 + sign * c(3, rep(-3 / (length(motions) - 1), length(motions) - 1))[match(rated$motion, motions)]
over_all <- model(line, crossed + rnorm(nrow(rated), 0, 0.01))["method1", "Estimate"]
cat(hits / times, over_all)
"""


# Reads the table of --format wide as people do: each column by its own name, with numbers or nothing.
WIDE = """
d <- read.csv("wide.csv")
for (n in setdiff(names(d), c("participant_id", "simulated", "group"))) {
  stopifnot(is.numeric(d[[n]]))
  cat(n, "\\t", sprintf("%.17g", mean(d[[n]], na.rm = TRUE)), "\\n", sep = "")
}
"""


def wide_means(told):
    """Maps the columns of --format wide to the means that JSON gives of their cells."""
    means = {}
    for name, run_told in told["runs"].items():
        rows = run_told.get("means") or run_told.get("correct") or run_told.get("chosen")
        rows = rows or {run_told["method"]: run_told["preference"]}
        for method, cells in rows.items():
            for motion, cell in cells["motion"].items():
                means[".".join(re.sub(r"[^0-9A-Za-z.]", "_", part) for part in (name, method, motion))] = cell["mean"]
    return means


def check_wide(tool, name, folder):
    (folder / "wide.csv").write_text(run(tool, "analyze", folder / name, "--format", "wide"))
    found = read(run("Rscript", "-e", WIDE, cwd=folder))
    expected = wide_means(json.loads(run(tool, "analyze", folder / name, "--format", "json")))
    bad = [f"--format wide: {list(found)}, not {list(expected)}"] if list(found) != list(expected) else []
    return bad + [f"{c}: {found[c]}, not {mean}" for c, mean in expected.items() if not abs(found.get(c, 1e9) - mean) < 1e-9]


def check_slopes(tool, name, folder):
    printed, flat, over_all = map(float, fit(tool, folder / name, SLOPES).split()[-3:])
    print(f"{name}: false effects of the method: {printed:.1%} by the line printed, {flat:.1%} without slopes")
    bad = [f"false effects: {printed:.1%}"] if printed > 0.1 else []
    bad += [f"without slopes only {flat:.1%}: the simulation shows nothing"] if flat < 0.25 else []
    return bad + ([f"the method's coefficient is {over_all}, not that over all motions"] if abs(over_all) > 0.05 else [])


# A run of each kind of model that measures. The simulated observers' truth in its coefficient, and how near the model comes:
# exponent (by the dB), exponent, d' of one method and over two, z of same and different, 0.6745 / jnd three times, and d' for 1 mm.
TRUTHS = [(0.6 * math.log(10) / 20, 0.05), (0.6, 0.05), (2, 0.15), (2, 0.15), (0.911, 0.25), (0.1686, 0.1), (0.1686, 0.1), (0.1686, 0.1), (0.25, 0.2)]
MEASURES = studies.measures(
    "palm-3x3",
    studies.run("size", "estimate", 60, question="How much was it?", vary="level_dbfs", values=[-40, -30, -20], methods=["park"]),
    studies.run("length", "estimate", 60, question="How much was it?", vary="length_mm", values=[5, 10, 20]),
    studies.run("there", "detect", 80, catch=0.5, methods=["park"]),
    studies.run("two", "detect", 80, catch=0.5),
    studies.run("same", "same-different", 40),
    studies.run("values", "constant", 100, question="Which was stronger?", vary="level_dbfs", values=[-32, -28, -24, -20, -16], standard=-24,
                methods=["park"]),
    studies.run("bayes", "adaptive", 60, question="Which was longer?", vary="length_mm", procedure="quest", range=[4, 20], standard=12, methods=["park"]),
    studies.run("intervals", "interval", 150, vary="level_dbfs", values=[-36, -32, -28, -24, -20, -16, -12], methods=["park"]),
    studies.run("odd", "oddity", 120, vary="length_mm", values=[14, 16, 18, 20], standard=12, methods=["park"]))
# sensR::triangle() made otherwise, because Debian lacks sensR: the share of right answers is a noncentral F.
COEFFICIENTS = COMMANDS + """
right <- function(d) pf(3, 1, 1, 2 * pmax(d, 0)^2 / 3, lower.tail = FALSE)
link <- structure(list(linkfun = function(mu) sapply(mu, function(p) uniroot(function(d) right(d) - max(p, 0.34), c(0, 20))$root),
  linkinv = right, mu.eta = function(d) pmax(4 / sqrt(6) * dnorm(d / sqrt(6)) * (pnorm(d / sqrt(2)) - 0.5), 1e-4),
  valideta = function(d) TRUE, name = "triangle"), class = "link-glm")
said <- gsub("sensR::triangle()", "binomial(link)", said, fixed = TRUE)
for (line in said[1:3]) suppressMessages(eval(parse(text = line)))
for (line in said[-(1:3)]) {
  b <- fixef(suppressMessages(suppressWarnings(eval(parse(text = line)))))
  cat("coefficient", b[grep("value|signal|^method1$", names(b))[1]], "\n")
}
for (p in split(d, d$participant)) {
  own <- p[p$run == "odd", ]
  cat("oddity", psyphy::dprime.oddity((sum(own$positive) + 0.5) / (nrow(own) + 1.5)), "\n")
}
"""


def check_measures(tool, folder):
    """Compares what R's mixed models find with what the simulated observers have."""
    (folder / "measures.toml").write_text(MEASURES)
    for code in ("01", "02", "03", "04", "05", "06"):
        run(tool, "experiment", folder / "measures.toml", "--participant", code, "-o", folder / "measured",
            "--simulate", "seed=1,jnd=4,dprime=2,exponent=0.6,sigma=0.2")
    said = fit(tool, folder / "measured", COEFFICIENTS).splitlines()
    found = [float(line.split()[1]) for line in said if line.startswith("coefficient")]
    if len(found) != len(TRUTHS):
        return [f"{len(found)} models, not {len(TRUTHS)}"]
    print("models of tasks that measure:", *(f"{c:.3f} ({truth:.3f})" for c, (truth, _) in zip(found, TRUTHS)))
    told = json.loads(run(tool, "analyze", folder / "measured", "--format", "json"))["runs"]["odd"]["dprime"]["participants"]
    odd = [float(line.split()[1]) for line in said if line.startswith("oddity")]
    bad = [f"d' of oddity is {p['dprime']}, psyphy has {d}" for p, d in zip(told.values(), odd, strict=True) if abs(p["dprime"] - d) > 1e-3]
    return bad + [f"coefficient {c}, not {truth}" for c, (truth, near) in zip(found, TRUTHS) if not abs(c / truth - 1) < near]


# The effect of a method at the standard, and at the value 0.
METHODS = studies.measures("palm-3x3", studies.run("values", "constant", 160, question="Which was stronger?", vary="level_dbfs",
                                                   values=[-32, -28, -24, -20, -16], standard=-24))
ERRORS = COMMANDS + """
for (line in said[1:3]) suppressMessages(eval(parse(text = line)))
for (line in c(said[4], gsub("I(value + 24)", "value", said[4], fixed = TRUE))) {
  b <- coef(summary(suppressMessages(suppressWarnings(eval(parse(text = line))))))["method1", ]
  cat("method", b[["Estimate"]], b[["Std. Error"]], "\n")
}
"""


def check_method_errors(tool, folder):
    """A method is compared at the standard: at the value 0 its error is far larger."""
    (folder / "methods.toml").write_text(METHODS)
    for code in ("01", "02", "03", "04", "05", "06"):
        run(tool, "experiment", folder / "methods.toml", "--participant", code, "-o", folder / "methods", "--simulate", "seed=1,jnd=4")
    found = [list(map(float, line.split()[1:])) for line in fit(tool, folder / "methods", ERRORS).splitlines() if line.startswith("method")]
    (effect, error), (_, at_zero) = found
    print(f"effect of a method: {effect:.3f}, standard error {error:.3f}, at the value 0 {at_zero:.3f}")
    bad = [] if abs(effect) < 3 * error else [f"methods that are alike differ: {effect} (se {error})"]
    return bad + ([] if at_zero > 2 * error else [f"the error at 0 is {at_zero}, at the standard {error}"])


# Figures of three methods: R compares those of each participant.
COMPARED = studies.measures("palm-3x3", studies.toml("method", "brush", algorithm="tactile-brush"),
                            studies.run("values", "constant", 210, question="Which was stronger?", vary="level_dbfs",
                                        values=[-32, -28, -24, -20, -16], standard=-24),
                            studies.toml("group", "a"), studies.toml("group", "b"), studies.toml("group", "c"))
COMPARE = """
d <- read.table("figures.tsv", header = TRUE)
for (figure in c("pse", "jnd")) {
  y <- as.matrix(d[grep(figure, names(d))])
  g <- factor(d$group)
  contrasts(g) <- contr.sum(3)
  b <- summary(car::Anova(lm(y ~ g), idata = data.frame(m = factor(1:3)), idesign = ~m, type = 3), multivariate = FALSE)
  say <- function(...) cat(figure, ..., "\n")
  p <- c()
  for (pair in list(c(1, 2), c(1, 3), c(2, 3))) {
    t <- t.test(y[, pair[1]], y[, pair[2]], paired = TRUE)
    x <- y[, pair[1]] - y[, pair[2]]
    p <- c(p, t$p.value)
    say(sprintf("%.17g", c(t$estimate, t$conf.int, t$statistic, t$parameter, t$p.value, mean(x) / sd(x))))
  }
  say(sprintf("%.17g", p.adjust(p, "holm")))
  a <- summary(car::Anova(lm(y ~ 1), idata = data.frame(m = factor(1:3)), idesign = ~m), multivariate = FALSE)
  u <- a$univariate.tests["m", ]
  e <- a$pval.adjustments["m", ]
  say(sprintf("%.17g", c(u["F value"], u["num Df"], u["den Df"], u["Pr(>F)"], e["GG eps"], e["Pr(>F[GG])"], e["HF eps"])))
  for (effect in c("g", "m", "g:m")) {
    u <- b$univariate.tests[effect, ]
    say(sprintf("%.17g", c(u["F value"], u["num Df"], u["den Df"], u["Pr(>F)"])))
  }
  say(sprintf("%.17g", c(b$pval.adjustments["m", c("GG eps", "Pr(>F[GG])")], b$pval.adjustments["g:m", c("GG eps", "Pr(>F[GG])")])))
  means <- rowMeans(y)
  for (pair in list(c("a", "b"), c("a", "c"), c("b", "c"))) {
    fit <- lm(means ~ relevel(factor(d$group), pair[2]))
    row <- paste0("relevel(factor(d$group), pair[2])", pair[1])
    u <- coef(summary(fit))[row, ]
    say(sprintf("%.17g", c(u[1], confint(fit)[row, ], u[3], df.residual(fit), u[4], u[1] / sigma(fit))))
  }
  h <- pairwise.t.test(means, d$group, p.adjust.method = "holm")$p.value
  say(sprintf("%.17g", c(h["b", "a"], h["c", "a"], h["c", "b"])))
}
"""


def check_comparisons(tool, folder):
    """Compares the figures of three methods and three groups of unequal size with what R says of the participants' figures."""
    (folder / "compared.toml").write_text(COMPARED)
    groups = {f"{i:02}": "aaabbbbcc"[i - 1] for i in range(1, 10)}
    for code, group in groups.items():
        run(tool, "experiment", folder / "compared.toml", "--participant", code, "--group", group, "-o", folder / "compared", "--simulate", "seed=1,jnd=4")
    told = json.loads(run(tool, "analyze", folder / "compared", "--format", "json"))["runs"]["values"]
    people = [told["by"][f"{m}:east"]["psychometric"]["participants"] for m in ("park", "soft", "brush")]
    rows = ["\t".join(["group", *(f"{figure}{i}" for figure in ("pse", "jnd") for i in range(3))])]
    rows += ["\t".join([groups[code], *(repr(own[code][figure]) for figure in ("pse", "jnd") for own in people)]) for code in people[0]]
    (folder / "figures.tsv").write_text("\n".join(rows) + "\n")
    said = [(line.split()[0], list(map(float, line.split()[1:]))) for line in run("Rscript", "-e", COMPARE, cwd=folder).splitlines()]
    expected = []
    for figure in ("pse", "jnd"):
        compared = told["methods"][figure]
        expected += [(figure, [p["difference"], *p["ci"], p["t"], p["df"], p["p"], p["d_z"]]) for p in compared["pairs"]]
        expected.append((figure, [p["p_holm"] for p in compared["pairs"]]))
        expected.append((figure, [compared["anova"][k] for k in ("F", "df1", "df2", "p", "epsilon_gg", "p_gg", "epsilon_hf")]))
        mixed = [compared["group_anova"][effect] for effect in ("group", "method", "group:method")]
        expected += [(figure, [e[k] for k in ("F", "df1", "df2", "p")]) for e in mixed]
        expected.append((figure, [e[k] for e in mixed[1:] for k in ("epsilon_gg", "p_gg")]))
        expected += [(figure, [p["difference"], *p["ci"], p["t"], p["df"], p["p"], p["d"]]) for p in compared["group_pairs"]]
        expected.append((figure, [p["p_holm"] for p in compared["group_pairs"]]))
    if len(said) != len(expected):
        return [f"R said {len(said)} lines, not {len(expected)}"]
    return [f"{figure}: {mine}, R: {r}" for (figure, mine), (_, r) in zip(expected, said)
            if not all(abs(a - b) <= 1e-8 * max(1, abs(b)) for a, b in zip(mine, r, strict=True))]


# Places and paths. R divides a path by interpolation over its length, and finds the Frechet distance by a table of all pairs.
DRAWN = studies.measures("palm-3x3", studies.toml("motion", "bend", path="M10 5Q30 5 30 35", duration=1.0),
                         studies.run("place", "locate", 24, max_in_a_row=9), studies.run("path", "trace", 24, max_in_a_row=9))
DRAW = """
points <- function(cell) matrix(as.numeric(unlist(strsplit(strsplit(cell, ";")[[1]], " "))), ncol = 3, byrow = TRUE)[, 2:3, drop = FALSE]
steps <- function(p) sqrt(rowSums(diff(p)^2))
along <- function(p, n) {
  s <- c(0, cumsum(steps(p)))
  sapply(1:2, function(k) approx(s, p[, k], seq(0, max(s), length.out = n + 1), ties = mean)$y)
}
frechet <- function(a, b) {
  d <- outer(1:nrow(a), 1:nrow(b), Vectorize(function(i, k) sqrt(sum((a[i, ] - b[k, ])^2))))
  f <- d
  for (i in 1:nrow(d)) for (k in 1:ncol(d)) {
    before <- c(if (i > 1) f[i - 1, k], if (k > 1) f[i, k - 1], if (i > 1 && k > 1) f[i - 1, k - 1])
    f[i, k] <- max(d[i, k], if (length(before)) min(before))
  }
  f[nrow(d), ncol(d)]
}
angle <- function(v) Arg(complex(real = v[1], imaginary = v[2]))
turns <- function(p) {
  q <- diff(along(p, 5))
  z <- complex(real = q[, 1], imaginary = q[, 2])
  sum(Arg(z[-1] / z[-5])) / (0.8 * sum(steps(p))) * 1000
}
say <- function(...) cat(sprintf("%.17g", c(...)), "\n")
for (code in c("01", "02", "03")) {
  read <- function(run) {
    d <- read.delim(sprintf("drawn/sub-%s/beh/sub-%s_task-%s_beh.tsv", code, code, run), na.strings = "n/a")
    d[d$void == "false", ]
  }
  d <- read("place")
  e <- t(mapply(function(r, t) points(r) - points(t), d$response, d$target))
  within <- function(x) sqrt(sum(sapply(split(x, d$motion), function(v) sum((v - mean(v))^2))) / (nrow(d) - length(unique(d$motion))))
  constant <- function(x) mean(sapply(split(x, d$motion), mean))
  say(mean(sqrt(rowSums(e^2))), constant(e[, 2]), constant(e[, 1]), within(e[, 2]), within(e[, 1]))
  d <- read("path")
  all <- mapply(function(r, t) {
    a <- points(r); b <- points(t)
    p <- along(a, 50); q <- along(b, 50)
    turn <- angle(a[nrow(a), ] - a[1, ]) - angle(b[nrow(b), ] - b[1, ])
    c(mean(sqrt(rowSums((p - q)^2))), frechet(p, q), sum(steps(a)) / sum(steps(b)), turn, turns(a) - turns(b))
  }, d$response, d$target)
  say(rowMeans(all[1:3, ]), Arg(mean(complex(argument = all[4, ]))) * 180 / pi, mean(all[5, ]))
}
"""


def check_drawings(tool, folder):
    """Compares the figures of places and paths with what R finds in the tables."""
    (folder / "drawn.toml").write_text(DRAWN)
    for code in ("01", "02", "03"):
        run(tool, "experiment", folder / "drawn.toml", "--participant", code, "-o", folder / "drawn", "--simulate", "seed=1,sigma=2,void=0.1")
    told = json.loads(run(tool, "analyze", folder / "drawn", "--format", "json"))["runs"]
    said = [list(map(float, line.split())) for line in run("Rscript", "-e", DRAW, cwd=folder).splitlines()]
    mine = [list(told[name]["drawings"]["participants"][code].values()) for code in ("01", "02", "03") for name in ("place", "path")]
    return [f"{m}, R: {r}" for m, r in zip(mine, said, strict=True)
            if not all(abs(a - b) <= 1e-8 * max(1, abs(b)) for a, b in zip(m, r, strict=True))]


APART = studies.measures("palm-3x3", studies.toml("method", "hard", burst=0.02), studies.toml("method", "wide", phantom="gaussian"),
                         studies.toml("motion", "bend", path="M10 5Q30 5 30 35", duration=1.0),
                         studies.run("apart", "dissimilar", 48, attribute="similarity"))
# The mean difference of each pair, both orders and the motions alike; cmdscale, and Kruskal's stress of its distances.
SCALE = """
methods <- c("park", "soft", "hard", "wide")
lay <- function(all) {
  m <- matrix(0, 4, 4)
  for (i in 1:4) for (k in 1:4) if (i != k) m[i, k] <- mean(sapply(c("east", "bend"), function(motion)
    mean(all$response[all$motion == motion & ((all$method_1 == methods[i] & all$method_2 == methods[k]) | (all$method_1 == methods[k] & all$method_2 == methods[i]))])))
  m
}
show <- function(m) {
  p <- cmdscale(m)
  p <- apply(p, 2, function(v) v * sign(v[which.max(abs(v))]))
  d <- as.matrix(dist(p))
  cat(format(c(m, p, sqrt(sum((d - m)^2) / sum(d^2))), digits = 15), "\n")
}
each <- lapply(c("01", "02", "03"), function(code) {
  t <- read.delim(sprintf("apart/sub-%s/beh/sub-%s_task-apart_beh.tsv", code, code), na.strings = "n/a")
  lay(t[t$void == "false", ])
})
show(Reduce("+", each) / 3)
for (m in each) show(m)
"""


def check_scaling(tool, folder):
    """Returns where places and stress of methods differ from those of R."""
    (folder / "apart.toml").write_text(APART)
    for code in ("01", "02", "03"):
        run(tool, "experiment", folder / "apart.toml", "--participant", code, "-o", folder / "apart", "--simulate", "seed=1,sigma=8,void=0.1")
    told = json.loads(run(tool, "analyze", folder / "apart", "--format", "json"))["runs"]["apart"]["scaling"]
    said = [list(map(float, line.split())) for line in run("Rscript", "-e", SCALE, cwd=folder).splitlines()]
    mine = [[*(d for row in one["differences"] for d in row), *(p[k] for k in (0, 1) for p in one["places"].values()), one["stress"]]
            for one in (told, *told["participants"].values())]
    return [f"{m}, R: {r}" for m, r in zip(mine, said, strict=True) if not all(abs(a - b) <= 1e-9 * max(1, abs(b)) for a, b in zip(m, r, strict=True))]


ADJUSTED = studies.measures("palm-3x3", studies.run("level", "adjust", 24, vary="level_dbfs", range=[-40, -8], steps=[0.5, 4], standard=-24))
# Constant error, mean and sd of each participant; the t test; the intercept of the model, which in a balanced design is the mean.
ADJUST = COMMANDS + """
for (line in said[1:3]) suppressMessages(eval(parse(text = line)))
per <- sapply(split(d$value, d$participant), function(v) c(mean(v) + 24, mean(v), sd(v)))
test <- t.test(per[1, ])
model <- fixef(suppressMessages(suppressWarnings(eval(parse(text = said[4])))))
cat(format(c(per, test$statistic, test$p.value, test$conf.int, model[["(Intercept)"]]), digits = 15))
"""


def check_adjustments(tool, folder):
    """Returns where the figures of adjustments differ from those of R."""
    (folder / "adjusted.toml").write_text(ADJUSTED)
    for code in ("01", "02", "03", "04", "05"):
        run(tool, "experiment", folder / "adjusted.toml", "--participant", code, "-o", folder / "adjusted", "--simulate", "seed=1,pse=-22,pse_sd=2,jnd=2")
    told = json.loads(run(tool, "analyze", folder / "adjusted", "--format", "json"))["runs"]["level"]["adjustment"]
    said = list(map(float, fit(tool, folder / "adjusted", ADJUST).split()))
    error = told["constant_error"]
    mine = [*(one[k] for one in told["participants"].values() for k in ("constant_error", "pse", "sd")), error["t"], error["p"], *error["ci"], error["mean"]]
    return [f"{m}, R: {r}" for m, r in zip(mine, said, strict=True) if not abs(m - r) <= 1e-7 * max(1, abs(r))]


ORDERS = studies.measures(
    "palm-3x3", studies.run("values", "constant", 200, question="Which was stronger?", vary="level_dbfs", values=[-32, -28, -24, -20, -16], standard=-24,
                            methods=["park"]),
    studies.run("intervals", "interval", 100, vary="level_dbfs", values=[-36, -30, -24, -18], methods=["park"]))
# The pse by maximum likelihood of the trials whose standard was in one interval; the per cent of right answers of two intervals.
ORDER = COMMANDS + """
for (line in said[1:3]) suppressMessages(eval(parse(text = line)))
pse <- function(q) {
  share <- function(x) pmin(pmax(x[3] / 2 + (1 - x[3]) * pnorm((q$value - x[1]) / exp(x[2])), 1e-12), 1 - 1e-12)
  loss <- function(x) -sum(dbinom(q$positive, 1, share(x), log = TRUE))
  fits <- lapply(c(0.001, 0.06, 0.119), function(lapse) optim(c(-24, log(6), lapse), loss, method = "L-BFGS-B", lower = c(-60, -2, 0), upper = c(20, 5, 0.12),
                                                              control = list(factr = 10, maxit = 1000)))
  fits[[which.min(sapply(fits, function(f) f$value))]]$par[1]
}
differences <- function(run, first, figure) sapply(split(d[d$run == run, ], d$participant[d$run == run]), function(own) {
  is_first <- (own$positive == 1) == (own$response == first)
  figure(own[!is_first, ]) - figure(own[is_first, ])
})
for (x in list(differences("values", 2, pse), differences("intervals", 1, function(q) 100 * mean(q$positive)))) {
  test <- t.test(x)
  cat(format(c(x, test$statistic, test$p.value, test$conf.int), digits = 15), "\n")
}
"""


def check_orders(tool, folder):
    """Returns where time-order errors differ from those of R, whose search for a pse ends within 0.005 of it."""
    (folder / "orders.toml").write_text(ORDERS)
    codes = ("01", "02", "03", "04")
    for code in codes:
        run(tool, "experiment", folder / "orders.toml", "--participant", code, "-o", folder / "orders", "--simulate", "seed=1,jnd=4")
    told = json.loads(run(tool, "analyze", folder / "orders", "--format", "json"))["runs"]
    said = [list(map(float, line.split())) for line in fit(tool, folder / "orders", ORDER).splitlines()]
    bad = []
    for name, r, near in zip(("values", "intervals"), said, (0.005, 1e-8), strict=True):
        own, test = told[name]["time_order"]["participants"], told[name]["time_order"]["difference"]
        mine = [*(own[code]["difference"] for code in codes), test["t"], test["p"], *test["ci"]]
        bad += [f"{name}: {m}, R: {v}" for m, v in zip(mine, r, strict=True) if not abs(m - v) <= near * max(1, abs(v))]
    return bad


SESSIONS = studies.measures(
    "palm-3x3", studies.toml("method", "hard", burst=0.02), studies.run("marks", "rate", 24, attribute="similarity"),
    studies.run("level", "constant", 120, question="Which was stronger?", vary="level_dbfs", values=[-32, -28, -24, -20, -16], standard=-24),
    studies.run("taste", "choose", 36, attribute="similarity"), studies.run("apart", "dissimilar", 24, attribute="similarity"),
    keys="sessions = 2\n")
# Terms of the session in each run's model. Then ratings by people who change from session to session, but not in common: how often
# the printed line finds an effect of the session all the same, and one without slopes.
CHANGES = COMMANDS + """
quiet <- function(line) suppressMessages(suppressWarnings(eval(parse(text = line), globalenv())))
for (line in said[1:3]) quiet(line)
for (line in said[-(1:3)]) cat("terms", length(grep("factor(session)1", names(fixef(quiet(line))), fixed = TRUE)), "\n")
d <- d[d$run == "marks", ]
line <- said[4]
flat <- sub(" + factor(session) |", " |", line, fixed = TRUE)
stopifnot(flat != line)
who <- match(d$participant, unique(d$participant))
people <- max(who)
set.seed(20261130)
found <- replicate(100, {
  d$rating <<- 3 + rnorm(people, 0, 0.5)[who] + (d$session - 1.5) * rnorm(people, 0, 0.8)[who] + rnorm(nrow(d), 0, 0.8)
  sapply(c(line, flat), function(l) 2 * pt(-abs(coef(summary(quiet(l)))["factor(session)1", "t value"]), people - 1) < 0.05)
})
cat("found", rowMeans(found), "\n")
"""


def check_sessions(tool, folder):
    """Checks that each model has the session as a factor, and that a slope by participant keeps it from finding too much."""
    (folder / "sessions.toml").write_text(SESSIONS)
    for code in ("01", "02", "03", "04", "05", "06", "07", "08"):
        for session in ("1", "2"):
            run(tool, "experiment", folder / "sessions.toml", "--participant", code, "--session", session, "-o", folder / "sessions",
                "--simulate", "seed=1,jnd=4,sigma=20")
    said = [line.split() for line in fit(tool, folder / "sessions", CHANGES).splitlines()]
    terms = [int(words[1]) for words in said if words[0] == "terms"]
    # The session; its interactions with two contrasts of methods, with the value and both, with two worths, with two contrasts of pairs.
    bad = [] if terms == [3, 6, 2, 3] else [f"terms of the session: {terms}"]
    printed, flat = next(map(float, words[1:]) for words in said if words[0] == "found")
    print(f"sessions: false effects of the session: {printed:.1%} by the line printed, {flat:.1%} without slopes")
    bad += [f"false effects: {printed:.1%}"] if printed > 0.1 else []
    return bad + ([f"without slopes only {flat:.1%}: the simulation shows nothing"] if flat < 0.25 else [])


def main():
    tool, write = pathlib.Path(sys.argv[1]).resolve(), "--write" in sys.argv
    has_lme4 = subprocess.run(["Rscript", "-e", "library(lme4)"], capture_output=True, check=False).returncode == 0
    passed = failed = skipped = 0
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        for name, make in studies.STUDIES.items():
            make(folder / name)
            studies.for_r(folder / name, folder / f"{name}.runs")
            cases = {name: lambda n=name: check(tool, n, folder, write),
                     f"{name}, wide": lambda n=name: check_wide(tool, n, folder)}
            if has_lme4:
                cases[f"{name}, models"] = lambda n=name: [] if "fitted" in fit(tool, folder / n, FIT) else ["nothing was fitted"]
                if name == "simulated":
                    cases[f"{name}, slopes"] = lambda n=name: check_slopes(tool, n, folder)
                    cases["measures, models"] = lambda: check_measures(tool, folder)
                    cases["measures, methods"] = lambda: check_method_errors(tool, folder)
                    cases["sessions, models"] = lambda: check_sessions(tool, folder)
                    cases["drawings"] = lambda: check_drawings(tool, folder)
                    cases["adjustments"] = lambda: check_adjustments(tool, folder)
                    cases["time order"] = lambda: check_orders(tool, folder)
                    cases["scaling"] = lambda: check_scaling(tool, folder)
                    cases["measures, comparisons"] = lambda: check_comparisons(tool, folder)
            else:
                print(f"SKIPPED: {name}, models: lme4 is not here")
                skipped += 1
            for what, case in cases.items():
                try:
                    bad = case()
                except RuntimeError as error:
                    bad = [str(error)]
                for line in bad[:20]:
                    print(line)
                if bad:
                    print(f"FAILED: {what}")
                failed += bool(bad)
                passed += not bad
    print(f"{passed} passed, {failed} failed, {skipped} skipped")
    return 1 if failed or not passed else 0


if __name__ == "__main__":
    sys.exit(main())
