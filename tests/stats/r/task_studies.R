# Whole results of simulated studies of Task 1 and Task 2 by R: every number of vip-stats' JSON that R can make. Means
# over three and four items, ties, dropout, unequal visits, a study of one person, one where all answers are equal.
#   Rscript task_studies.R > task_studies.json
# Not made: BCa intervals (their resamples are the program's own), cumulative-link mixed models (lme and MASS have
# none; tests/stats/oracle holds those of R's ordinal), and the sensitivity analyses, which are the same tests again.
set.seed(20)
source("task_studies_lib.R")

# Reports of Task 1: one scene at each n_*, the methods in any order. A person who drops out leaves the later
# reports unanswered. `shift` moves realism towards the end of the scale, `coarse` leaves three scores, `gaps`
# is the chance that a report is left out.
task1_answers <- function(people, visits, dropout, equal, shift = 0, coarse = FALSE, gaps = 0) {
  rows <- NULL
  quality <- c(-1.4, -0.5, 0.4, 0.7, 0.5)
  for (person in seq_len(people)) {
    level <- rnorm(1, sd = 0.6); sick <- rnorm(1, sd = 0.3)
    for (visit in seq_len(sample(visits, 1))) {
      stop_at <- if (runif(1) < dropout) sample(10, 1) else 11
      cells <- expand.grid(method = sample(5), n_star = sample(2))
      shown <- sample(3, 2)
      for (i in seq_len(10)) {
        cell <- cells[i, ]
        realism <- min(7, max(1, round(4 + shift + quality[cell$method] + level + rnorm(1))))
        if (coarse) realism <- c(1, 1, 1, 4, 7, 7, 7)[realism]
        sickness <- pmin(3, pmax(0, round(0.9 - 0.4 * quality[cell$method] + sick + rnorm(4, sd = 0.7))))
        if (equal) { realism <- 4; sickness <- rep(1, 4) }
        left_out <- gaps > 0 && runif(1) < gaps
        answers <- if (i < stop_at && !left_out) c(realism, sickness) else rep(NA, 5)
        rows <- rbind(rows, c(person, visit, i - 1, shown[cell$n_star], cell$n_star, cell$method, answers))
      }
    }
  }
  colnames(rows) <- c("person", "visit", "position", "scene", "n_star", "method", "realism", items)
  as.data.frame(rows)
}

scores <- list(realism = "realism", sickness = items, sickness_without_unrealism = setdiff(items, "unrealism"))

# Sum and number of answers of each person about a method at an n_*.
column <- function(rows, people, n_star, method, of) {
  sums <- rep(NA, people); counts <- rep(1, people)
  for (person in seq_len(people)) {
    own <- rows[rows$person == person & rows$n_star == n_star & rows$method == method & !is.na(rows$realism), of, drop = FALSE]
    if (nrow(own) == 0) next
    sums[person] <- sum(own); counts[person] <- length(of) * nrow(own)
  }
  list(sum = sums, count = counts)
}

task1_results <- function(rows, decision, directional) {
  answered <- rows[!is.na(rows$realism), ]
  analysed <- sort(unique(answered$person))
  rows$person <- match(rows$person, analysed); rows <- rows[!is.na(rows$person), ]
  people <- length(analysed)
  cells <- comparisons <- omni <- scene_list <- list()
  kept <- list()  # columns by score, n_*, method
  for (score in names(scores)) {
    for (n_star in 1:2) {
      columns <- lapply(1:5, function(method) column(rows, people, n_star, method, scores[[score]]))
      kept[[score]][[n_star]] <- columns
      where <- list(score = score, n_star = n_stars[n_star])
      family <- list()
      for (a in 1:5) {
        values <- (columns[[a]]$sum / columns[[a]]$count)
        cells <- c(cells, list(c(where, list(method = methods[a]), one_cell(values[!is.na(values)]))))
        for (b in seq_len(5)[seq_len(5) > a])
          family <- c(family, list(c(where, list(a = methods[a], b = methods[b]),
                                     comparison(compare(columns[[a]], columns[[b]]), margins[[score]]))))
      }
      p <- vapply(family, function(one) as.numeric(one$p), 0)
      ranked <- vapply(family, function(one) if (is.null(one$wilcoxon)) NA else as.numeric(one$wilcoxon$p), 0)
      for (i in seq_along(family)) {
        family[[i]]$p_holm <- corrected(p, "holm")[i]; family[[i]]$p_bh <- corrected(p, "BH")[i]
        family[[i]]$stars_holm <- stars(family[[i]]$p_holm)
        if (!is.null(family[[i]]$wilcoxon))
          family[[i]]$wilcoxon <- c(family[[i]]$wilcoxon, list(p_holm = corrected(ranked, "holm")[i], p_bh = corrected(ranked, "BH")[i]))
      }
      comparisons <- c(comparisons, family)
      omni <- c(omni, list(c(where, omnibus(do.call(cbind, lapply(columns, function(one) one$sum / one$count))))))
    }
    for (n_star in 1:2) for (scene in 1:3) for (method in 1:5) {
      own <- answered[answered$n_star == n_star & answered$scene == scene & answered$method == method, scores[[score]], drop = FALSE]
      if (nrow(own) == 0) next
      values <- rowSums(own) / length(scores[[score]])
      scene_list <- c(scene_list, list(list(score = score, n_star = n_stars[n_star], scene = scenes[scene], method = methods[method],
                                            n = length(values), mean = mean(values), sd = if (length(values) > 1) sd(values) else NA)))
    }
  }
  means <- list()
  for (person in seq_len(people)) for (n_star in 1:2) for (method in 1:5) {
    line <- lapply(names(scores), function(score) {
      one <- kept[[score]][[n_star]][[method]]
      one$sum[person] / one$count[person]
    })
    if (all(is.na(unlist(line)))) next
    means <- c(means, list(c(list(participant = sprintf("P%02d", analysed[person]), n_star = n_stars[n_star], method = methods[method]),
                             setNames(line, names(scores)))))
  }
  list(task1 = list(participants = people, reports = nrow(answered), cells = cells, by_scene = scene_list,
                    comparisons = comparisons, omnibus = omni, participant_means = means),
       hypotheses = over_six(task1_claims(kept, decision, directional)))
}

# Whether a hypothesis is tested one-sided.
sided <- function(id, directional) isTRUE(directional) || (directional == "H2, H3 and H6" && id %in% c("H2", "H3", "H6"))

contrast <- function(kept, id, score, n_star, a, b, directional) {
  pair <- compare(kept[[score]][[n_star]][[match(a, methods)]], kept[[score]][[n_star]][[match(b, methods)]])
  one <- sided(id, directional)
  better <- if (score == "realism") 1 else -1
  margin <- margins[[score]]
  level <- if (one) alpha else alpha / 2
  out <- list(label = paste0(a, " - ", b, ", ", score, ", ", n_stars[n_star]), score = score, n_star = n_stars[n_star], a = a,
              b = b, n = pair$n, margin = if (id == "H1") NA else margin)
  side <- function(up) if (up) "greater" else "less"
  if (pair$same) {
    d <- pair$d[1]
    worst <- -better * margin
    p <- switch(id, H1 = sign_p(pair, 0, if (one) side(better > 0) else "two.sided"),
                H2 = max(sign_p(pair, -margin, "greater"), sign_p(pair, margin, "less")),
                H3 = sign_p(pair, worst, if (one) side(better > 0) else "two.sided"))
    if (id == "H2" && !one) p <- min(1, 2 * p)
    right <- one || switch(id, H1 = better * d > 0, H2 = TRUE, H3 = better * (d - worst) > 0)
    return(c(out, list(method = "exact sign test", estimate = d, ci = NA, p = p, right = right, paper_p = NA)))
  }
  test <- attempt(t.test(pair$x, pair$y, paired = TRUE))
  if (is.null(test)) return(c(out, list(method = "paired t test", estimate = NA, ci = NA, p = NA, right = TRUE, paper_p = NA)))
  at <- function(mu, side) t.test(pair$x, pair$y, paired = TRUE, mu = mu, alternative = side)
  ci <- as.vector(t.test(pair$x, pair$y, paired = TRUE, conf.level = 1 - 2 * level)$conf.int)
  right <- TRUE
  if (id == "H1") {
    used <- if (one) at(0, side(better > 0)) else test
    p <- used$p.value; right <- one || better * test$estimate > 0
  } else if (id == "H2") {
    lower <- at(-margin, "greater"); upper <- at(margin, "less")
    used <- if (lower$p.value > upper$p.value) lower else upper
    p <- if (one) used$p.value else min(1, 2 * used$p.value)
  } else {
    used <- at(-better * margin, if (one) side(better > 0) else "two.sided")
    p <- used$p.value; right <- one || better * used$statistic > 0
  }
  c(out, list(method = "paired t test", estimate = unname(test$estimate), ci = ci, ci_confidence = 1 - 2 * level,
              t = unname(used$statistic), df = unname(test$parameter), d_z = unname(test$statistic) / sqrt(pair$n), p = p,
              right = unname(right), paper_p = test$p.value))
}

task1_claims <- function(kept, decision, directional) {
  family <- function(id, a, b) {
    tests <- list()
    for (score in c("realism", "sickness")) for (first in a) for (n_star in 1:2)
      tests <- c(tests, list(contrast(kept, id, score, n_star, first, b, directional)))
    decided(id, tests, decision, id != "H1")  # nobody's gaze was tracked
  }
  list(family("H1", c("Ours", "Ours-TSp"), "FovFluid"), family("H2", c("Ours", "Ours-TSp"), "HiRes"), family("H3", "Ours-TSp", "Ours"))
}

# Task 2: all pairs once; who comes again judges a few pairs a second time.
# `winner` is a method that always wins: the strengths are separated.
task2_answers <- function(people, dropout, again, equal, winner = 0) {
  rows <- NULL
  strength <- c(-0.9, -0.4, 0.3, 0.5, 0.4)
  for (person in seq_len(people)) {
    own <- strength + rnorm(5, sd = 0.8)
    for (visit in seq_len(if (runif(1) < again) 2 else 1)) {
      pairs <- t(combn(5, 2)); pairs <- pairs[sample(10), ]
      if (visit == 2) pairs <- pairs[1:2, , drop = FALSE]
      stop_at <- if (runif(1) < dropout) sample(10, 1) else 11
      scene <- sample(3, 1)
      for (i in seq_len(nrow(pairs))) {
        pair <- if (runif(1) < 0.5) pairs[i, ] else rev(pairs[i, ])
        first <- runif(1) < plogis(own[pair[1]] - own[pair[2]] + 0.2)
        if (equal) first <- pair[1] > pair[2]
        if (winner %in% pair) first <- pair[1] == winner
        rows <- rbind(rows, c(person, visit, i - 1, scene, pair, if (i < stop_at) 2 - first else NA))
      }
    }
  }
  colnames(rows) <- c("person", "visit", "position", "scene", "first", "second", "chosen")
  as.data.frame(rows)
}

pair_counts <- function(rows, a, b) {
  own <- rows[(rows$first == a & rows$second == b) | (rows$first == b & rows$second == a), ]
  list(n = nrow(own), participants = length(unique(own$person)), k = sum((own$chosen == 1) == (own$first == a)),
       a_first = sum(own$first == a), first_chosen = sum(own$chosen == 1),
       max_per_participant = if (nrow(own)) max(table(own$person)) else 0)
}

# For each person who was shown the pair: how often they chose a, and how many answers they gave.
person_choices <- function(rows, a, b) {
  own <- rows[(rows$first == a & rows$second == b) | (rows$first == b & rows$second == a), ]
  chose_a <- (own$chosen == 1) == (own$first == a)
  list(k = as.vector(tapply(chose_a, own$person, sum)), n = as.vector(tapply(chose_a, own$person, length)))
}

# Exact permutation test of each person's share less one half: all signs are equally likely; the sum by convolution.
share_test <- function(people, side) {
  steps <- (2 * people$k - people$n) * (lcm(people$n) / people$n)
  mass <- 1
  for (step in abs(steps)) mass <- (c(mass, rep(0, 2 * step)) + c(rep(0, 2 * step), mass)) / 2
  sums <- seq_along(mass) - 1 - sum(abs(steps))
  shares <- people$k / people$n
  ci <- if (!constant(shares)) as.vector(t.test(shares, mu = 0.5, alternative = side)$conf.int)
        else if (shares[1] %in% 0:1) as.vector(binom.test(shares[1] * length(shares), length(shares), alternative = side)$conf.int)
        else c(0, 1)
  list(participants = length(shares), share = mean(shares), ci = pmin(1, pmax(0, ci)),
       p = min(1, sum(mass[if (side == "greater") sums >= sum(steps) else abs(sums) >= abs(sum(steps))])))
}

one_pair <- function(rows, a, b) {
  count <- pair_counts(rows, a, b)
  out <- c(list(a = methods[a], b = methods[b]), count, list(share = if (count$n) count$k / count$n else NA))
  if (count$n == 0 || count$max_per_participant > 1) {
    none <- list(p_mid = NA, clopper_pearson = NA, wilson = NA, cohen_g = NA)
    if (count$n == 0) return(c(out, none, list(p = NA)))
    shares <- share_test(person_choices(rows, a, b), "two.sided")
    return(c(out, none, list(p = shares$p, by_person = shares)))
  }
  test <- binom.test(count$k, count$n)
  tail <- function(k) pbinom(k, count$n, 0.5) - dbinom(k, count$n, 0.5) / 2
  c(out, list(p = test$p.value, p_mid = min(1, 2 * min(tail(count$k), tail(count$n - count$k))),
              clopper_pearson = as.vector(test$conf.int),
              wilson = as.vector(suppressWarnings(prop.test(count$k, count$n, correct = FALSE))$conf.int), cohen_g = count$k / count$n - 0.5))
}

# Circular triads of one person: triples in which each method wins once.
circular <- function(own) {
  wins <- matrix(0, 5, 5)
  for (i in seq_len(nrow(own))) {
    pair <- c(own$first[i], own$second[i]); if (own$chosen[i] == 2) pair <- rev(pair)
    wins[pair[1], pair[2]] <- wins[pair[1], pair[2]] + 1
  }
  if (any((wins + t(wins))[upper.tri(wins)] != 1)) return(NA)
  choose(5, 3) - sum(choose(rowSums(wins), 2))
}
# Probabilities of 0 to 5 circular triads over all 2^10 ways to choose in the ten pairs.
random_triads <- local({
  pairs <- t(combn(5, 2)); out <- integer(0)
  for (code in 0:1023) {
    first <- bitwAnd(code, 2^(0:9)) > 0
    scores <- tabulate(ifelse(first, pairs[, 1], pairs[, 2]), 5)
    out <- c(out, choose(5, 3) - sum(choose(scores, 2)))
  }
  table(factor(out, 0:5)) / 1024
})

bradley <- function(rows, terms) {
  x <- matrix(0, nrow(rows), 5)
  x[cbind(seq_len(nrow(rows)), rows$first)] <- 1
  x[cbind(seq_len(nrow(rows)), rows$second)] <- -1
  x <- x[, -1]
  if (terms > 0) x <- cbind(x, 1)
  if (terms > 1) x <- cbind(x, rows$position - mean(rows$position))
  y <- as.numeric(rows$chosen == 1)
  fit <- glm(y ~ 0 + x, family = binomial, control = glm.control(epsilon = 1e-14, maxit = 100))
  pull <- rowsum(x * (y - fitted(fit)), rows$person)
  list(fit = fit, people = nrow(pull),
       covariance = vcov(fit) %*% crossprod(pull) %*% vcov(fit) * nrow(pull) / (nrow(pull) - 1))
}

order_term <- function(with, without) {
  last <- length(coef(with$fit)); estimate <- unname(coef(with$fit)[last]); se <- sqrt(with$covariance[last, last])
  df <- with$people - 1
  chi2 <- deviance(without$fit) - deviance(with$fit)
  list(estimate = estimate, se = se, se_independent = sqrt(vcov(with$fit)[last, last]), ci = estimate + c(-1, 1) * qt(0.975, df) * se,
       p = 2 * pt(-abs(estimate / se), df), people_df = df, chi2 = chi2, df = 1, p_independent = pchisq(chi2, 1, lower.tail = FALSE))
}

strengths <- function(rows) {
  model <- bradley(rows, 0); fit <- model$fit; df <- model$people - 1; k <- 4
  centre <- rbind(0, diag(k)) - matrix(1 / 5, 5, k)
  lambda <- as.vector(centre %*% coef(fit))
  error <- function(m, covariance) sqrt(pmax(0, diag(m %*% covariance %*% t(m))))
  se <- error(centre, model$covariance)
  pairs <- t(combn(5, 2))
  contrast <- t(apply(pairs, 1, function(p) { v <- numeric(5); v[p] <- c(1, -1); v[-1] }))
  difference <- as.vector(contrast %*% coef(fit)); difference_se <- error(contrast, model$covariance)
  reach <- qt(0.975, df)
  # Likelihood ratio against a model with one free proportion for each pair, whichever method was shown first.
  wins <- t(apply(pairs, 1, function(p) { one <- pair_counts(rows, p[1], p[2]); c(one$k, one$n - one$k) }))
  expected <- plogis(difference) * rowSums(wins)
  part <- function(x, m) ifelse(x == 0, 0, x * log(x / m))
  fit_chi2 <- 2 * sum(part(wins[, 1], expected) + part(wins[, 2], rowSums(wins) - expected))
  equal_chi2 <- 2 * sum(part(wins[, 1], rowSums(wins) / 2) + part(wins[, 2], rowSums(wins) / 2)) - fit_chi2
  t2 <- as.numeric(t(coef(fit)) %*% solve(model$covariance, coef(fit)))
  f <- t2 * (model$people - k) / (k * df)
  with <- bradley(rows, 1); drift <- bradley(rows, 2)
  interval <- order_term(with, model)
  list(penalised = FALSE,
       people = list(errors = "people", people_df = df,
                     equal = list(f = f, df1 = k, df2 = model$people - k, p = pf(f, k, model$people - k, lower.tail = FALSE))),
       abilities = lapply(1:5, function(i) list(method = methods[i], estimate = lambda[i], se = se[i],
                                                se_independent = error(centre, vcov(fit))[i], ci = lambda[i] + c(-1, 1) * reach * se[i],
                                                worth = exp(lambda[i]) / sum(exp(lambda)))),
       differences = lapply(seq_len(nrow(pairs)), function(i)
         list(a = methods[pairs[i, 1]], b = methods[pairs[i, 2]], estimate = difference[i], se = difference_se[i],
              se_independent = error(contrast, vcov(fit))[i], ci = difference[i] + c(-1, 1) * reach * difference_se[i],
              p = 2 * pt(-abs(difference[i] / difference_se[i]), df), probability = plogis(difference[i]),
              probability_ci = plogis(difference[i] + c(-1, 1) * reach * difference_se[i]))),
       overall = list(chi2 = equal_chi2, df = k, p = pchisq(equal_chi2, k, lower.tail = FALSE)),
       fit = list(chi2 = fit_chi2, df = 6, p = pchisq(fit_chi2, 6, lower.tail = FALSE)),
       order = c(interval, list(first_probability = plogis(interval$estimate), first_probability_ci = plogis(interval$ci),
                                drift = order_term(drift, with))))
}

task2_claims <- function(rows, pairs, decision, directional) {
  p <- vapply(pairs, function(pair) as.numeric(pair$p), 0)
  in_figure <- vapply(pairs, function(pair) {
    both <- c(pair$a, pair$b)
    setequal(both, c("Ours", "Ours-TSp")) || (any(c("Ours", "Ours-TSp") %in% both) && any(c("FovFluid", "HiRes") %in% both))
  }, NA)
  of_five <- p; of_five[in_figure] <- corrected(p[in_figure], "holm"); of_five[!in_figure] <- NA
  one <- function(id, a, b) {
    index <- which(vapply(pairs, function(pair) setequal(c(pair$a, pair$b), c(a, b)), NA))
    count <- pair_counts(rows, match(a, methods), match(b, methods))
    out <- list(label = paste(a, "preferred to", b), method = "exact binomial test", a = a, b = b, n = count$n, margin = NA)
    two <- pairs[[index]]$p
    if (is.na(two)) return(c(out, list(estimate = NA, ci = NA, p = NA, right = TRUE, paper_p = NA)))
    side <- if (sided(id, directional)) "greater" else "two.sided"
    test <- binom.test(count$k, count$n, alternative = side)
    if (id != "H6") out <- c(out, list(p_holm_of_five = of_five[index], p_holm_of_ten = corrected(p, "holm")[index]))
    if (count$max_per_participant > 1) {
      shares <- share_test(person_choices(rows, match(a, methods), match(b, methods)), side)
      out$method <- "exact permutation test of people's shares"
      return(c(out, list(k = count$k, estimate = shares$share, ci = shares$ci, p = shares$p, right = shares$share > 0.5,
                         paper_p = two)))
    }
    c(out, list(k = count$k, estimate = count$k / count$n, ci = as.vector(test$conf.int), p = test$p.value,
                right = count$k > count$n / 2, paper_p = two))
  }
  list(decided("H4", list(one("H4", "Ours-TSp", "Ours")), decision),
       decided("H5", list(one("H5", "Ours", "FovFluid"), one("H5", "Ours-TSp", "FovFluid")), decision, FALSE),
       decided("H6", list(one("H6", "HiRes", "Ours"), one("H6", "HiRes", "Ours-TSp")), decision))
}

# True if a method wins or loses all of its pairs: the program then penalises the strengths, which R's glm cannot do.
separated <- function(rows) any(vapply(1:5, function(method) {
  won <- ifelse(rows$chosen == 1, rows$first, rows$second)[rows$first == method | rows$second == method] == method
  length(won) == 0 || all(won) || !any(won)
}, NA))

task2_results <- function(rows, decision, directional) {
  rows <- rows[!is.na(rows$chosen), ]
  analysed <- sort(unique(rows$person))
  index <- t(combn(5, 2))
  pairs <- lapply(seq_len(10), function(i) one_pair(rows, index[i, 1], index[i, 2]))
  p <- vapply(pairs, function(pair) as.numeric(pair$p), 0)
  for (i in 1:10) pairs[[i]] <- c(pairs[[i]], list(p_holm = corrected(p, "holm")[i], p_bh = corrected(p, "BH")[i], stars = stars(p[i]),
                                                   stars_holm = stars(corrected(p, "holm")[i])))
  first <- binom.test(sum(rows$chosen == 1), nrow(rows))
  shares <- tapply(rows$chosen == 1, rows$person, mean)
  by <- if (constant(shares)) NULL else attempt(t.test(shares, mu = 0.5))
  bias <- list(n = nrow(rows), first_chosen = sum(rows$chosen == 1), share = mean(rows$chosen == 1), p = first$p.value,
               clopper_pearson = as.vector(first$conf.int),
               wilson = as.vector(suppressWarnings(prop.test(sum(rows$chosen == 1), nrow(rows), correct = FALSE))$conf.int))
  if (!is.null(by))
    bias$by_participant <- list(test = "t test", mean_share = unname(by$estimate), ci = as.vector(by$conf.int), n = length(shares),
                                t = unname(by$statistic), df = unname(by$parameter), p = by$p.value)
  if (constant(shares)) {
    sign <- if (shares[1] == 0.5) 1 else min(1, 2 * 2^-length(shares))
    bias$by_participant <- list(test = "exact sign test", mean_share = unname(shares[1]), n = length(shares), p = sign)
  }
  triads <- vapply(analysed, function(person) as.numeric(circular(rows[rows$person == person, ])), 0)
  whole <- which(!is.na(triads))
  group <- list(incomplete = sum(is.na(triads)), n = length(whole),
                participants = lapply(whole, function(i) list(participant = sprintf("P%02d", analysed[i]), circular = triads[i],
                                                              consistency = 1 - triads[i] / 5, p = sum(random_triads[0:triads[i] + 1]))))
  if (length(whole) > 0) {
    sums <- 1
    for (i in whole) sums <- convolve(sums, rev(as.vector(random_triads)), type = "open")
    group <- c(group, list(mean = mean(triads[whole]), mean_consistency = mean(1 - triads[whole] / 5), expected = 2.5,
                           p = sum(sums[seq_len(sum(triads[whole]) + 1)])))
  }
  scene_list <- list()
  for (scene in 1:3) for (i in 1:10) {
    count <- pair_counts(rows[rows$scene == scene, ], index[i, 1], index[i, 2])
    if (count$n > 0) scene_list <- c(scene_list, list(list(scene = scenes[scene], a = methods[index[i, 1]], b = methods[index[i, 2]],
                                                           n = count$n, k = count$k)))
  }
  out <- list(participants = length(analysed), answers = nrow(rows), pairs = pairs, interval_bias = bias, triads = group, by_scene = scene_list)
  if (length(analysed) > 6 && !separated(rows)) out$bradley_terry <- strengths(rows)
  list(task2 = out, hypotheses = over_six(task2_claims(rows, pairs, decision, directional)))
}

# `of` names another study with the same answers. The output then has only the hypotheses, which differ.
study <- function(name, task, rows, decision = "intersection-union", directional = FALSE, of = "") {
  results <- if (task == 1) task1_results(rows, decision, directional) else task2_results(rows, decision, directional)
  if (of != "") { results <- results["hypotheses"]; rows <- rows[0, ] }
  sprintf('{"name": "%s", "task": %d, "decision": "%s", "directional": %s, "of": "%s",\n "rows": [%s],\n "results": %s}', name, task, decision,
          json(directional), of, paste(apply(rows, 1, function(row) json(unname(row))), collapse = ", "), json(results))
}

mess1 <- task1_answers(14, 1:3, 0.3, FALSE)
mess2 <- task2_answers(18, 0.2, 0.1, FALSE)
studies <- c(study("task 1", 1, mess1), study("task 1, one-sided", 1, mess1, directional = TRUE, of = "task 1"),
             study("task 1, as bundles were once frozen", 1, mess1, "holm", "H2, H3 and H6", of = "task 1"),
             study("task 1, five people", 1, task1_answers(5, 1:2, 0.2, FALSE)),
             study("task 1, one person", 1, task1_answers(1, c(1, 1), 0, FALSE)),
             study("task 1, all answers equal", 1, task1_answers(9, 1:2, 0.2, TRUE)), study("task 2", 2, mess2),
             study("task 2, one-sided", 2, mess2, directional = TRUE, of = "task 2"),
             study("task 2, as bundles were once frozen", 2, mess2, "holm", "H2, H3 and H6", of = "task 2"),
             study("task 2, one person", 2, task2_answers(1, 0, 0, FALSE)),
             study("task 2, everybody chooses alike", 2, task2_answers(9, 0.2, 0, TRUE)))
six1 <- task1_answers(6, 1:2, 0, FALSE, coarse = TRUE)
skew1 <- task1_answers(24, 1:2, 0.3, FALSE, shift = 2.2, gaps = 0.1)
forty1 <- task1_answers(40, 1:2, 0.5, FALSE, coarse = TRUE, gaps = 0.15)
again2 <- task2_answers(24, 0.2, 0.5, FALSE)
sixty2 <- task2_answers(60, 0.3, 0.3, FALSE)
studies <- c(studies, study("task 1, six people, ties", 1, six1),
             study("task 1, answers at the end of the scale, reports left out", 1, skew1),
             study("task 1, the same after Holm, one-sided", 1, skew1, "holm", TRUE,
                   of = "task 1, answers at the end of the scale, reports left out"),
             study("task 1, forty people, half leave early", 1, forty1),
             study("task 2, six people", 2, task2_answers(6, 0, 0, FALSE)), study("task 2, second visits", 2, again2),
             study("task 2, second visits, one-sided", 2, again2, directional = TRUE, of = "task 2, second visits"),
             study("task 2, sixty people", 2, sixty2),
             study("task 2, sixty people after Holm", 2, sixty2, "holm", of = "task 2, sixty people"),
             study("task 2, one method always wins", 2, task2_answers(16, 0.2, 0, FALSE, winner = 3)))
cat(sprintf('{"r": "%s", "script": "task_studies.R", "studies": [\n%s]}\n', R.version.string, paste(studies, collapse = ",\n")))
