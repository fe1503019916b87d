# SPDX-License-Identifier: MIT
# What `tactor analyze --format json` says of a study, computed by R: Rscript analyze.R STUDY_FOLDER RUNS_FILE
# Prints a line for each figure: its place in the JSON, a tab, its value or NA. Where R has several ways (aov, mlm and the
# package car), they must agree, or this stops.
options(digits = 17, warn = 1)
args <- commandArgs(TRUE)
folder <- args[1]
runs <- read.delim(args[2], header = FALSE, quote = "", col.names = c("name", "task", "motions", "methods"))
has_car <- requireNamespace("car", quietly = TRUE)
list_of_people <- read.delim(file.path(folder, "participants.tsv"), colClasses = "character")
people <- sub("^sub-", "", list_of_people$participant_id)

say <- function(place, value) cat(place, "\t", if (is.null(value) || is.na(value)) "NA" else sprintf("%.17g", value), "\n", sep = "")
agree <- function(a, b, what) if (abs(a - b) > 1e-8 * max(1, abs(a))) stop(what, ": ", a, " is not ", b)

trials_of <- function(run, code) {
  file <- file.path(folder, paste0("sub-", code), "beh",
                    paste0("sub-", code, "_task-", gsub("[^0-9A-Za-z]", "", run), "_beh.tsv"))
  if (!file.exists(file)) return(NULL)
  d <- read.delim(file, na.strings = "n/a", quote = "", colClasses = "character")
  d[d$void == "false", ]
}

# Of t and its effect size, and of signs.

noncentrality <- function(t, df, below) {
  f <- function(delta) suppressWarnings(pt(t, df, delta)) - below
  uniroot(f, c(t - 8, t + 8), extendInt = "downX", tol = 1e-13, maxiter = 10000)$root
}
signs <- function(x) { # all of them, one by one
  grid <- as.matrix(expand.grid(rep(list(c(-1, 1)), length(x))))
  mean(abs(grid %*% x) >= abs(sum(x)) - 1e-9 * sum(abs(x)))
}
constant <- function(x) length(x) < 2 || diff(range(x)) <= 1e-12 * max(abs(x))
# Intervals within participants (Cousineau 2005, Morey 2008): a row for each participant, a column for each condition.
within <- function(values) {
  n <- nrow(values)
  k <- ncol(values)
  apply(values - rowMeans(values) + mean(values), 2, function(x) {
    if (n < 2 || k < 2 || constant(x)) return(c(NA, NA))
    mean(x) + c(-1, 1) * qt(0.975, n - 1) * sd(x) / sqrt(n) * sqrt(k / (k - 1))
  })
}
say_ends <- function(place, ends) for (i in 1:2) say(paste0(place, ".", i - 1), ends[i])
test <- function(place, x, mu, paired = FALSE) {
  n <- length(x)
  one <- n > 1 && !constant(x)
  r <- if (one) t.test(x, mu = mu) else NULL
  d <- if (one) (mean(x) - mu) / sd(x)
  ends <- if (one) c(noncentrality(r$statistic, n - 1, 0.975), noncentrality(r$statistic, n - 1, 0.025)) / sqrt(n)
  names <- if (paired) c("difference", "d_z", "d_z_ci") else c("mean", "d", "d_ci")
  say(paste0(place, ".", names[1]), mean(x))
  if (!paired) say(paste0(place, ".se"), if (n > 1) sd(x) / sqrt(n) else NA)
  for (i in 1:2) say(paste0(place, ".ci.", i - 1), if (one) r$conf.int[i] else NA)
  say(paste0(place, ".t"), if (one) unname(r$statistic) else NA)
  say(paste0(place, ".df"), if (n > 1) n - 1 else NA)
  p <- if (one) r$p.value else NA
  say(paste0(place, ".p"), p)
  say(paste0(place, ".p_signflip"), if (n > 1) signs(x - mu) else NA)
  say(paste0(place, ".", names[2]), d)
  for (i in 1:2) say(paste0(place, ".", names[3], ".", i - 1), ends[i])
  p
}
tests <- function(place, values, motions, mu, within_all, within_motions) { # values: a row for each participant
  test(paste0(place, ".all"), rowMeans(values), mu)
  say_ends(paste0(place, ".all.ci_within"), within_all)
  p <- sapply(motions, function(m) test(paste0(place, ".motion.", m), values[, m], mu))
  for (i in seq_along(motions)) say_ends(paste0(place, ".motion.", motions[i], ".ci_within"), within_motions[, i])
  holm <- p.adjust(p, "holm")
  for (m in motions) say(paste0(place, ".motion.", m, ".p_holm"), holm[m])
}

# Analysis of variance: by strata (aov), sphericity from the multivariate model, all of it again by car.

long <- function(values, factors) {
  d <- data.frame(v = as.vector(t(values)), who = factor(rep(seq_len(nrow(values)), each = ncol(values))))
  for (f in names(factors)) d[[f]] <- factor(rep(as.character(factors[[f]]), nrow(values)), levels(factors[[f]]))
  d
}
squares <- function(values, factors) {
  d <- long(values, factors)
  within <- paste(names(factors), collapse = " * ")
  # Two tables that aov() makes are of one stratum where there is one factor.
  s <- summary(aov(as.formula(paste0("v ~ ", within, " + Error(who / (", within, "))")), d))
  out <- list(people = s[["Error: who"]][[1]]["Residuals", "Sum Sq"], effects = list())
  for (stratum in names(s)[-1]) {
    table <- s[[stratum]][[1]]
    rownames(table) <- trimws(rownames(table))
    name <- sub("^Error: who:", "", stratum)
    out$effects[[name]] <- c(ss = table[name, "Sum Sq"], df1 = table[name, "Df"],
                             error = table["Residuals", "Sum Sq"], df2 = table["Residuals", "Df"])
  }
  out
}
spherical <- function(values, factors, name) {
  fit <- lm(values ~ 1)
  terms <- if (length(factors) == 1) list("~1", paste0("~", name)) else switch(name,
    method = list("~motion", "~method+motion"), motion = list("~method", "~method+motion"),
    list("~method+motion", "~method*motion"))
  X <- as.formula(terms[[1]]); M <- as.formula(terms[[2]])
  rank <- function(f) qr(model.matrix(f, factors))$rank
  p <- rank(M) - rank(X)
  out <- c(epsilon = NA, hf = NA, w = NA, p = NA)
  if (p < 2) return(out)
  project <- function(f) { m <- model.matrix(f, factors); m %*% solve(crossprod(m)) %*% t(m) }
  T <- svd(project(M) - project(X))$u[, 1:p]
  lambda <- eigen(t(T) %*% crossprod(residuals(fit)) %*% T, symmetric = TRUE)$values
  out["epsilon"] <- sum(lambda)^2 / p / sum(lambda^2)
  rest <- fit$df.residual - p * out["epsilon"]
  if (rest > 1e-9) out["hf"] <- ((fit$df.residual + 1) * p * out["epsilon"] - 2) / (p * rest)
  if (fit$df.residual >= p && min(lambda) > 1e-12 * max(lambda)) {
    m <- mauchly.test(fit, X = X, M = M, idata = factors)
    out[c("w", "p")] <- c(m$statistic, m$p.value)
  }
  out
}
by_car <- function(values, factors) {
  if (!has_car || nrow(values) <= ncol(values)) return(NULL) # it wants the multivariate tests, too
  keep <- options(contrasts = c("contr.sum", "contr.poly"))
  on.exit(options(keep))
  design <- as.formula(paste("~", paste(names(factors), collapse = "*")))
  suppressWarnings(summary(car::Anova(lm(values ~ 1), idata = factors, idesign = design, type = 3), multivariate = FALSE))
}
effects <- function(place, values, factors) {
  s <- squares(values, factors)
  all_error <- s$people + sum(sapply(s$effects, function(e) e["error"]))
  car <- by_car(values, factors)
  for (name in names(s$effects)) {
    e <- s$effects[[name]]
    f <- unname((e["ss"] / e["df1"]) / (e["error"] / e["df2"]))
    sph <- spherical(values, factors, name)
    at <- function(k) paste0(place, ".", name, ".", k)
    say(at("F"), f)
    say(at("df1"), e["df1"])
    say(at("df2"), e["df2"])
    p <- pf(f, e["df1"], e["df2"], lower.tail = FALSE)
    p_gg <- pf(f, sph["epsilon"] * e["df1"], sph["epsilon"] * e["df2"], lower.tail = FALSE)
    hf <- min(1, sph["hf"])
    p_hf <- pf(f, hf * e["df1"], hf * e["df2"], lower.tail = FALSE)
    say(at("p"), p)
    say(at("epsilon_gg"), sph["epsilon"])
    say(at("p_gg"), p_gg)
    say(at("epsilon_hf"), sph["hf"])
    say(at("p_hf"), p_hf)
    say(at("mauchly_w"), sph["w"])
    say(at("mauchly_p"), sph["p"])
    say(at("eta2_partial"), e["ss"] / (e["ss"] + e["error"]))
    say(at("eta2_generalised"), e["ss"] / (e["ss"] + all_error))
    if (is.null(car)) next
    u <- car$univariate.tests[name, ]
    agree(u["F value"], f, "car: F")
    agree(u["Pr(>F)"], p, "car: p")
    if (is.na(sph["w"])) next
    agree(car$sphericity.tests[name, "Test statistic"], sph["w"], "car: W")
    agree(car$sphericity.tests[name, "p-value"], sph["p"], "car: Mauchly's p")
    agree(car$pval.adjustments[name, "GG eps"], sph["epsilon"], "car: epsilon")
    agree(car$pval.adjustments[name, "Pr(>F[GG])"], p_gg, "car: p of Greenhouse and Geisser")
    agree(car$pval.adjustments[name, "HF eps"], sph["hf"], "car: epsilon of Huynh and Feldt")
    agree(car$pval.adjustments[name, "Pr(>F[HF])"], p_hf, "car: p of Huynh and Feldt")
  }
}
# Groups compared by car with sums of squares of type III; the group again by aov, from the means of participants.
compare_groups <- function(place, values, group, factors) {
  keep <- options(contrasts = c("contr.sum", "contr.poly"))
  on.exit(options(keep))
  design <- as.formula(paste("~", paste(names(factors), collapse = "*")))
  s <- suppressWarnings(summary(car::Anova(lm(values ~ group), idata = factors, idesign = design, type = 3), multivariate = FALSE))
  table <- unclass(s$univariate.tests)
  agree(table["group", "F value"], summary(aov(rowMeans(values) ~ group))[[1]][1, "F value"], "aov: F of groups")
  all_error <- sum(table[!grepl("group", rownames(table)), "Error SS"])
  for (name in setdiff(rownames(table), "(Intercept)")) {
    at <- function(k) paste0(place, ".", name, ".", k)
    e <- table[name, ]
    adjusted <- function(column) if (name %in% rownames(s$pval.adjustments)) s$pval.adjustments[name, column]
    spherical <- function(column) if (name %in% rownames(s$sphericity.tests)) s$sphericity.tests[name, column]
    say(at("F"), e["F value"])
    say(at("df1"), e["num Df"])
    say(at("df2"), e["den Df"])
    say(at("p"), e["Pr(>F)"])
    say(at("epsilon_gg"), adjusted("GG eps"))
    say(at("p_gg"), adjusted("Pr(>F[GG])"))
    say(at("epsilon_hf"), adjusted("HF eps"))
    say(at("p_hf"), adjusted("Pr(>F[HF])"))
    say(at("mauchly_w"), spherical("Test statistic"))
    say(at("mauchly_p"), spherical("p-value"))
    say(at("eta2_partial"), e["Sum Sq"] / (e["Sum Sq"] + e["Error SS"]))
    say(at("eta2_generalised"), e["Sum Sq"] / (e["Sum Sq"] + all_error))
  }
}
pairs <- function(place, values, motions) {
  e <- squares(values, list(motion = factor(motions, motions)))$effects$motion
  i <- 0
  for (a in seq_along(motions)) for (b in seq_along(motions)) if (a < b) {
    at <- function(k) paste0(place, ".", i, ".", k)
    difference <- mean(values[, a]) - mean(values[, b])
    q <- unname(abs(difference) / sqrt(e["error"] / e["df2"] / nrow(values)))
    say(at("difference"), difference)
    say(at("q"), q)
    say(at("p"), ptukey(q, length(motions), e["df2"], lower.tail = FALSE))
    i <- i + 1
  }
}
# The model of Bradley and Terry: 1 where a method was felt first, -1 where it was felt second, no intercept.
worths <- function(place, d, methods) {
  x <- sapply(methods[-1], function(m) (d$method_1 == m) - (d$method_2 == m))
  fit <- glm(d$response == "1" ~ 0 + x, family = binomial, control = list(epsilon = 1e-14, maxit = 100))
  figures <- rbind(0, coef(summary(fit))[, c("Estimate", "Std. Error")])
  for (i in seq_along(methods)) {
    say(paste0(place, ".log_worth.", methods[i]), figures[i, 1])
    say(paste0(place, ".se.", methods[i]), figures[i, 2])
  }
}

paired <- function(place, values, motions) {
  tests <- list()
  for (a in seq_along(motions)) for (b in seq_along(motions)) if (a < b) {
    x <- values[, a] - values[, b]
    tests <- c(tests, list(c(difference = mean(x), t = NA, df = length(x) - 1, p = NA)))
    if (constant(x)) next
    r <- t.test(values[, a], values[, b], paired = TRUE)
    tests[[length(tests)]][c("t", "p")] <- c(r$statistic, r$p.value)
  }
  holm <- p.adjust(sapply(tests, function(t) t["p"]), "holm")
  for (i in seq_along(tests)) {
    for (k in names(tests[[i]])) say(paste0(place, ".", i - 1, ".", k), tests[[i]][k])
    say(paste0(place, ".", i - 1, ".p_holm"), holm[i])
  }
}
times <- function(place, people, task, motions, methods) { # people: the trials of each participant in the figures
  median_of <- function(keep) {
    median(sapply(people, function(d) median(as.numeric(d$response_time[keep(d)]), na.rm = TRUE)), na.rm = TRUE)
  }
  say(paste0(place, ".median_s"), median_of(function(d) TRUE))
  for (method in if (task == "choose") NA else methods) for (motion in motions) {
    name <- if (is.na(method)) motion else paste0(method, ":", motion)
    say(paste0(place, ".by.", name), median_of(function(d) d$motion == motion & (is.na(method) | d$method_1 == method)))
  }
}

for (k in seq_len(nrow(runs))) {
  run <- runs$name[k]
  task <- runs$task[k]
  motions <- strsplit(runs$motions[k], ",")[[1]]
  methods <- strsplit(runs$methods[k], ",")[[1]]
  several <- task == "choose" && length(methods) > 2
  rows <- if (task == "choose" && !several) "all" else methods
  values <- lapply(rows, function(r) NULL)
  names(values) <- rows
  first <- c()
  compared <- NULL
  answered <- list()
  group <- NULL
  confusion <- array(0, c(length(methods), length(motions), length(motions)), list(methods, motions, motions))
  for (code in people) {
    d <- trials_of(run, code)
    if (is.null(d)) next
    d$score <- switch(task,
      choose = 100 * (ifelse(d$response == "1", d$method_1, d$method_2) == tail(methods, 1)),
      rate = as.numeric(d$rating),
      identify = 100 * (d$response == d$motion))
    row <- if (task == "choose") rep("all", nrow(d)) else d$method_1
    scores <- d$score
    motion <- d$motion
    if (several) { # each trial is in the row of both methods
      row <- c(d$method_1, d$method_2)
      scores <- 100 * c(d$response == "1", d$response == "2")
      motion <- c(motion, motion)
    }
    cells <- tapply(scores, list(factor(row, rows), factor(motion, motions)), mean)
    if (anyNA(cells)) next
    compared <- rbind(compared, d)
    group <- c(group, list_of_people$group[match(code, people)])
    for (r in rows) values[[r]] <- rbind(values[[r]], cells[r, ])
    first <- c(first, 100 * mean(d$response == "1"))
    answered <- c(answered, list(d))
    if (task == "identify") for (i in seq_len(nrow(d))) {
      at <- cbind(d$method_1[i], d$motion[i], d$response[i])
      confusion[at] <- confusion[at] + 1
    }
  }
  place <- paste0("runs.", run)
  say(paste0(place, ".n"), nrow(values[[1]]))
  times(paste0(place, ".response_time"), answered, task, motions, methods)
  by_motion <- factor(motions, motions)
  cells <- within(do.call(cbind, values)) # by row, then motion
  all <- within(matrix(sapply(values, rowMeans), ncol = length(rows)))
  by_cell <- data.frame(method = factor(rep(rows, each = length(motions)), rows), motion = rep(by_motion, length(rows)))
  if (!is.null(group) && !several)
    compare_groups(paste0(place, ".group_anova"), do.call(cbind, values), factor(group), if (length(rows) > 1) by_cell else by_cell["motion"])
  cells_of <- function(i) cells[, (i - 1) * length(motions) + seq_along(motions), drop = FALSE]
  if (task == "choose") {
    if (several) {
      for (i in seq_along(methods)) tests(paste0(place, ".chosen.", methods[i]), values[[methods[i]]], motions, 50, all[, i], cells_of(i))
      worths(paste0(place, ".bradley_terry"), compared, methods)
    } else tests(paste0(place, ".preference"), values[[1]], motions, 50, all[, 1], cells_of(1))
    t <- if (constant(first)) list(statistic = NA, p.value = NA) else t.test(first, mu = 50)
    say(paste0(place, ".first_interval.mean"), mean(first))
    say(paste0(place, ".first_interval.t"), unname(t$statistic))
    say(paste0(place, ".first_interval.p"), t$p.value)
    if (several) next
    effects(paste0(place, ".anova"), values[[1]], data.frame(motion = by_motion))
    pairs(paste0(place, ".tukey"), values[[1]], motions)
  } else if (task == "rate") {
    for (m in methods) for (what in c("all", motions)) {
      x <- if (what == "all") rowMeans(values[[m]]) else values[[m]][, what]
      at <- paste0(place, ".means.", m, if (what == "all") ".all" else paste0(".motion.", what))
      say(paste0(at, ".mean"), mean(x))
      say(paste0(at, ".se"), sd(x) / sqrt(length(x)))
      for (i in 1:2) say(paste0(at, ".ci.", i - 1), if (constant(x)) NA else t.test(x)$conf.int[i])
      k <- match(m, methods)
      say_ends(paste0(at, ".ci_within"), if (what == "all") all[, k] else cells_of(k)[, match(what, motions)])
    }
    test(paste0(place, ".paired"), rowMeans(values[[length(methods)]]) - rowMeans(values[[1]]), 0, paired = TRUE)
    effects(paste0(place, ".anova"), do.call(cbind, values), by_cell)
    for (m in methods) pairs(paste0(place, ".tukey.", m), values[[m]], motions)
  } else {
    say(paste0(place, ".chance"), 100 / length(motions))
    for (m in methods) {
      k <- match(m, methods)
      tests(paste0(place, ".correct.", m), values[[m]], motions, 100 / length(motions), all[, k], cells_of(k))
      paired(paste0(place, ".pairs.", m), values[[m]], motions)
      for (i in motions) for (j in motions) say(paste0(place, ".confusion.", m, ".", i, ".", j), confusion[m, i, j])
    }
  }
}
