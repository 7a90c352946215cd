# Linear mixed models of simulated studies of Task 1 by lme4 and lmerTest: all answers of a study, with dropout, with
# several visits, with a variance at its bound, with one number of particles (n_*). Prints mixed_model.json:
#   Rscript mixed_model.R > mixed_model.json
suppressMessages(library(lmerTest))
set.seed(15)
num <- function(x) sprintf("%.17g", x)
list_of <- function(x) paste0("[", paste(x, collapse = ", "), "]")

# One row for each answer: person, scene, n_star, method, y, position, period. A block shows all methods of one scene at
# one n_*. `leave` is the chance to stop before a trial; who stops gives no later answer.
simulate <- function(people, blocks, n_stars, sd_person, sd_method, leave, items) {
  rows <- NULL
  for (person in 1:people) {
    level <- rnorm(1, 0, sd_person); own <- rnorm(5, 0, sd_method); here <- TRUE
    for (block in 1:blocks) {
      scene <- (person + block) %% 3; n_star <- (person + block) %% n_stars
      for (at in 1:5) { if (at == 1) order <- sample(5)
        here <- here && runif(1) >= leave
        method <- order[at]; place <- 5 * (block - 1) + at - 1
        mean <- 4 + c(-0.8, -0.3, 0.2, 0.4, 0)[method] + 0.2 * scene - 0.02 * place + level + own[method]
        y <- if (items == 1) min(7, max(1, round(rnorm(1, mean, 0.9))))
             else sum(pmin(3, pmax(0, round(rnorm(items, mean - 3, 0.7)))))
        if (here) rows <- rbind(rows, c(person - 1, scene, n_star, method - 1, y, place, block))
      }
    }
  }
  d <- as.data.frame(rows); names(d) <- c("person", "scene", "n_star", "method", "sum", "position", "period")
  d$y <- d$sum / items
  d
}

fitted <- function(d, replicated) {
  d$cell <- factor(10 * d$n_star + d$method); d$scene <- factor(d$scene); d$period <- factor(d$period)
  fixed <- "y ~ 0 + cell"
  for (term in c("scene", "period")) if (nlevels(d[[term]]) > 1) fixed <- paste(fixed, "+", term)
  random <- if (replicated) "(1 | person) + (1 | person:method)" else "(1 | person)"
  suppressMessages(lmer(as.formula(paste(fixed, "+ position +", random)), d, REML = TRUE,
    control = lmerControl(optimizer = "bobyqa", optCtrl = list(rhobeg = 0.2, rhoend = 1e-11, maxfun = 1e5))))
}

row_of <- function(test) list_of(num(unlist(test[c("Estimate", "Std. Error", "df", "t value", "lower", "upper", "Pr(>|t|)")])))
study <- function(name, d, items, replicated = TRUE) {
  m <- fitted(d, replicated); beta <- fixef(m); cells <- levels(factor(10 * d$n_star + d$method)); tests <- NULL
  for (first in seq_along(cells)) for (second in seq_along(cells)) {
    a <- as.integer(cells[first]); b <- as.integer(cells[second])
    if (a >= b || a %/% 10 != b %/% 10) next
    weights <- setNames(rep(0, length(beta)), names(beta))
    weights[paste0("cell", c(a, b))] <- c(1, -1)
    tests <- c(tests, sprintf('{"n_star": %d, "a": %d, "b": %d, "test": %s}', a %/% 10, a %% 10, b %% 10,
                              row_of(contest1D(m, weights, confint = TRUE))))
  }
  others <- NULL
  for (term in setdiff(names(beta), paste0("cell", cells)))
    others <- c(others, sprintf('"%s": %s', term, row_of(contest1D(m, as.numeric(names(beta) == term), confint = TRUE))))
  sds <- as.data.frame(VarCorr(m))
  sd_of <- function(group) { at <- sds$sdcor[sds$grp == group]; if (length(at)) num(at) else "null" }
  sprintf('{"name": "%s", "items": %d, "singular": %s, "criterion": %s,\n "sd": {"person": %s, "method": %s, "residual": %s},\n "answers": %s,\n "tests": [%s],\n "others": {%s}}',
          name, items, if (isSingular(m)) "true" else "false", num(REMLcrit(m)), sd_of("person"), sd_of("person:method"),
          sd_of("Residual"), list_of(apply(d[c("person", "scene", "n_star", "method", "sum", "position", "period")], 1, list_of)),
          paste(tests, collapse = ",\n  "), paste(others, collapse = ", "))
}
# Simulated again until a variance is at its bound.
at_bound <- function(group, ...) repeat {
  d <- simulate(...); sds <- as.data.frame(VarCorr(fitted(d, TRUE)))
  if (sds$sdcor[sds$grp == group] < 1e-8) return(d)
}

studies <- c(
  study("complete", simulate(26, 2, 2, 0.8, 0.5, 0, 1), 1),
  study("half left", simulate(26, 2, 2, 0.8, 0.5, 0.1, 1), 1),
  study("few people, six blocks", simulate(6, 6, 2, 0.5, 0.6, 0.01, 4), 4),
  study("no spread by method", at_bound("person:method", 12, 2, 2, 0.7, 0, 0.02, 4), 4),
  study("no spread of levels", at_bound("person", 10, 2, 2, 0, 0.6, 0.02, 1), 1),
  study("one n_*", simulate(14, 1, 1, 0.8, 0.3, 0.05, 1), 1, FALSE))
cat(sprintf('{"r": "%s", "lme4": "%s", "lmerTest": "%s", "script": "mixed_model.R", "studies": [\n%s]}\n', R.version.string,
            packageVersion("lme4"), packageVersion("lmerTest"), paste(studies, collapse = ",\n")))
