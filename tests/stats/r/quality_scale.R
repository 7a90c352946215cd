# Scales of quality in just-objectionable differences, for tests/stats/preference/quality_scale_test.cpp. Prints
# quality_scale.json: Rscript quality_scale.R > quality_scale.json
#
# tmo_choices.csv is examples/ex3_tmo_cmp_data.csv of github.com/mantiuk/pwcmp (MIT licence, Copyright 2016 mantiuk),
# with other names of columns, and tmo_scaled.csv its published result (examples/ex3_tmo_cmp_scaled.csv, commit
# 043cfd6). sound_quality.csv has the counts of SoundQuality in R's package psychotools 0.7.2 (GPL-2; Choisel and
# Wickelmaier 2007), vegetables.csv those of vegetables in psychTools 2.2.9 (GPL; Guilford 1954; 148 people).
num <- function(x) ifelse(is.na(x), "null", sprintf("%.15g", x))
list_of <- function(x) paste0("[", paste(num(x), collapse = ", "), "]")
sigma <- 1 / qnorm(0.75)

# Rows: person, first, second (from 1), first chosen, count.
rows_of <- function(d, conditions) {
  count <- if (is.null(d$count)) rep(1, nrow(d)) else d$count
  person <- if (is.null(d$person)) rep(1, nrow(d)) else match(d$person, unique(d$person))
  data.frame(person = person, first = match(d$first, conditions), second = match(d$second, conditions),
             chosen = as.numeric(d$chosen == "first"), count = count)
}

design <- function(rows, items, order) {
  x <- matrix(0, nrow(rows), items)
  x[cbind(seq_len(nrow(rows)), rows$first)] <- 1
  x[cbind(seq_len(nrow(rows)), rows$second)] <- x[cbind(seq_len(nrow(rows)), rows$second)] - 1
  x <- x[, -1, drop = FALSE] / sigma
  if (order) x <- cbind(x, 1 / sigma)
  x
}

probit <- function(rows, items, order = FALSE) {
  glm(rows$chosen ~ 0 + design(rows, items, order), weights = rows$count, family = binomial("probit"),
      control = glm.control(epsilon = 1e-14, maxit = 100))
}

centred <- function(items) rbind(0, diag(items - 1)) - matrix(1 / items, items, items - 1)

# A set of items that wins, or loses, every comparison with the others has no finite place.
finite <- function(rows, items) {
  w <- matrix(0, items, items)
  for (i in seq_len(nrow(rows))) {
    r <- rows[i, ]
    if (r$chosen == 1) w[r$first, r$second] <- 1 else w[r$second, r$first] <- 1
  }
  reach <- (w > 0) | diag(items) > 0
  for (k in seq_len(items)) reach <- reach | (reach %*% reach > 0)
  all(reach)
}

# Maximum likelihood by glm; sandwich and jackknife over people.
choices_case <- function(name, d, order = FALSE, people = TRUE) {
  conditions <- sort(unique(c(d$first, d$second)))
  rows <- rows_of(d, conditions)
  rows <- rows[rows$count > 0, ]
  items <- length(conditions)
  fit <- probit(rows, items, order)
  beta <- coef(fit)
  q <- as.vector(centred(items) %*% beta[seq_len(items - 1)])
  parts <- c(name = sprintf('"%s"', name), conditions = paste0("[", paste(sprintf('"%s"', conditions), collapse = ", "), "]"),
             jod = list_of(q))
  # The observed information, which is that of the probit's likelihood itself.
  x <- design(rows, items, order)
  eta <- as.vector(x %*% beta)
  ratio <- function(e) exp(dnorm(e, log = TRUE) - pnorm(e, log.p = TRUE))
  signs <- ifelse(rows$chosen == 1, 1, -1)
  m <- ratio(signs * eta)
  score_rows <- x * (signs * m * rows$count)
  info <- crossprod(x, x * (rows$count * m * (m + signs * eta)))
  inverse <- solve(info)
  transform <- centred(items)
  if (order) { transform <- rbind(cbind(transform, 0), c(rep(0, items - 1), 1)); parts["order"] <- num(beta[items]) }
  parts["model_se"] <- list_of(sqrt(diag(transform %*% inverse %*% t(transform))))
  if (people) {
    pull <- rowsum(score_rows, rows$person)
    n <- nrow(pull)
    sandwich <- transform %*% inverse %*% crossprod(pull) %*% inverse %*% t(transform) * n / (n - 1)
    parts["se_sandwich"] <- list_of(sqrt(diag(sandwich)))
    left <- lapply(sort(unique(rows$person)), function(p) rows[rows$person != p, ])
    if (all(sapply(left, finite, items = items))) {
      without <- sapply(left, function(r) as.vector(transform %*% coef(probit(r, items, order))))
      se <- sqrt((n - 1) / n * rowSums((without - rowMeans(without))^2))
      parts["se"] <- list_of(se)
      parts["low"] <- list_of((as.vector(transform %*% beta) - qt(0.975, n - 1) * se)[seq_len(items)])
      if (!order) {
        l <- p <- answers <- numeric(n)
        for (i in seq_len(n)) {
          own <- rows[rows$person == i, ]
          win <- matrix(0, items, items)
          for (k in seq_len(nrow(own))) {
            a <- if (own$chosen[k] == 1) own$first[k] else own$second[k]
            b <- if (own$chosen[k] == 1) own$second[k] else own$first[k]
            win[a, b] <- win[a, b] + own$count[k]
          }
          prob <- pnorm(outer(without[, i], without[, i], "-") / sigma)
          sel <- upper.tri(win) & (win + t(win) > 0)
          l[i] <- sum(dbinom(win[sel], (win + t(win))[sel], prob[sel], log = TRUE))
          p[i] <- l[i] - sum(lchoose((win + t(win))[sel], win[sel]))
          answers[i] <- sum(own$count)
        }
        score <- function(v) { h <- quantile(v, c(.25, .75), type = 5, names = FALSE); ifelse(v < h[1], (h[1] - v) / (h[2] - h[1]), 0) }
        parts["observers"] <- list_of(l)
        pairs <- combn(items, 2)
        t <- apply(pairs, 2, function(i) {
          v <- without[i[1], ] - without[i[2], ]
          (q[i[1]] - q[i[2]]) / sqrt((n - 1) / n * sum((v - mean(v))^2))
        })
        parts["p"] <- list_of(2 * pt(-abs(t), n - 1))
        parts["scores"] <- list_of(score(l))
        parts["scores_per_answer"] <- list_of(score(p / answers))
      }
    }
  }
  paste0("{", paste0('"', names(parts), '": ', parts, collapse = ",\n  "), "}")
}

# Ratings and choices of one set of conditions: a literal likelihood, maximised by nlm and optim.
joint_case <- function(seed, items, people, prior) {
  set.seed(seed)
  q <- seq(-1.5, 1.5, length.out = items)
  rows <- ratings <- NULL
  for (p in seq_len(people)) {
    own <- q + rnorm(items, sd = 0.5)
    offset <- rnorm(1, sd = 0.6)
    pairs <- t(combn(items, 2))
    for (i in seq_len(nrow(pairs))) {
      pair <- if (runif(1) < 0.5) pairs[i, ] else rev(pairs[i, ])
      rows <- rbind(rows, c(p, pair, as.numeric(own[pair[1]] - own[pair[2]] + 0.3 + rnorm(1, sd = sigma) > 0)))
    }
    for (i in seq_len(items)) ratings <- rbind(ratings, c(p, i, findInterval(0.6 * own[i] + offset + rnorm(1), c(-1, -0.2, 0.5, 1.2)) + 1))
  }
  levels <- sort(unique(ratings[, 3]))
  minus <- function(x, rows, ratings) {
    v <- c(0, x[seq_len(items - 1)]); w <- x[items]; k <- x[items + 1]
    t <- c(-Inf, cumsum(c(x[items + 2], exp(x[-seq_len(items + 2)]))), Inf)
    eta <- (v[rows[, 2]] - v[rows[, 3]] + w) / sigma
    level <- match(ratings[, 3], levels)
    l <- sum(pnorm(ifelse(rows[, 4] == 1, eta, -eta), log.p = TRUE)) +
      sum(log(pnorm(t[level + 1] - k * v[ratings[, 2]]) - pnorm(t[level] - k * v[ratings[, 2]])))
    if (prior) l <- l - sum((v - mean(v))^2) / (2 * 25) - k^2 / (2 * 4)
    -l
  }
  best <- function(rows, ratings, start) {
    for (i in 1:4) start <- optim(start, minus, rows = rows, ratings = ratings, method = "BFGS", control = list(reltol = 1e-16, maxit = 1000))$par
    nlm(minus, start, rows = rows, ratings = ratings, gradtol = 1e-10, steptol = 1e-12, iterlim = 500)$estimate
  }
  shown <- function(x) { v <- c(0, x[seq_len(items - 1)]); c(v - mean(v), x[items], x[items + 1]) }
  x <- best(rows, ratings, c(rep(0, items), 0.5, -1, rep(-0.3, length(levels) - 2)))
  without <- sapply(seq_len(people), function(p) shown(best(rows[rows[, 1] != p, ], ratings[ratings[, 1] != p, ], x)))
  se <- sqrt((people - 1) / people * rowSums((without - rowMeans(without))^2))
  t <- cumsum(c(x[items + 2], exp(x[-seq_len(items + 2)])))
  v <- c(0, x[seq_len(items - 1)])
  sprintf('{"prior": "%s", "items": %d,\n "pairs": [%s],\n "ratings": [%s],\n "estimates": %s,\n "thresholds": %s,\n "se": %s}',
          if (prior) "normal" else "none", items, paste(apply(rows, 1, list_of), collapse = ", "),
          paste(apply(ratings, 1, list_of), collapse = ", "), list_of(shown(x)), list_of(t - x[items + 1] * mean(v)), list_of(se))
}

tmo <- read.csv("tmo_choices.csv", colClasses = "character")
sound <- read.csv("sound_quality.csv", colClasses = c(rep("character", 4), "numeric"))
vegetables <- read.csv("vegetables.csv")
scenes <- sort(unique(tmo$scene))
choices <- c(sapply(scenes, function(s) choices_case(paste("tmo", s), tmo[tmo$scene == s, ])),
             choices_case("tmo window order", tmo[tmo$scene == "window", ], order = TRUE),
             choices_case("sound quality", sound), choices_case("vegetables", vegetables, people = FALSE))
joint <- c(joint_case(3, 5, 12, FALSE), joint_case(4, 4, 9, TRUE))
cat(sprintf('{"r": "%s", "script": "quality_scale.R",\n"choices": [\n%s],\n"joint": [\n%s]}\n', R.version.string,
            paste(choices, collapse = ",\n"), paste(joint, collapse = ",\n")))
