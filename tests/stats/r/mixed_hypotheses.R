# The tests of H1 to H3 by the mixed model: what follows from lmerTest's estimates, errors and degrees of freedom in
# mixed_model.json, for a score of which more is better and for one of which less is. Prints mixed_hypotheses.json:
#   Rscript mixed_hypotheses.R < mixed_model.json > mixed_hypotheses.json
text <- readLines(file("stdin"))
num <- function(x) sprintf("%.17g", x)
margins <- c(realism = 0.5, sickness = 0.25); methods <- c("LoRes", "FovFluid", "Ours", "Ours-TSp", "HiRes")
claims <- list(H1 = list(c(2, 1), c(3, 1)), H2 = list(c(2, 4), c(3, 4)), H3 = list(c(3, 2)))

tested <- function(id, score, est, se, df, one) {
  better <- if (score == "realism") 1 else -1; m <- margins[[score]]; level <- if (one) 0.05 else 0.025
  sides <- function(t) if (one) pt(better * t, df, lower.tail = FALSE) else 2 * pt(-abs(t), df)
  null <- if (id == "H1") 0 else -better * m
  t <- (est - null) / se; p <- sides(t)
  if (id == "H2") {
    lower <- pt((est + m) / se, df, lower.tail = FALSE); upper <- pt((est - m) / se, df)
    p <- if (one) max(lower, upper) else min(1, 2 * max(lower, upper))
    t <- (est - if (lower > upper) -m else m) / se
  }
  half <- qt(level, df, lower.tail = FALSE) * se; low <- est - half; high <- est + half
  holds <- if (id == "H2") low > -m && high < m else if (better > 0) low > null else high < null
  sprintf('"estimate": %s, "df": %s, "t": %s, "p": %s, "ci": [%s, %s], "holds": %s', num(est), num(df), num(t), num(p),
          num(low), num(high), if (holds) "true" else "false")
}

lines <- NULL; study <- -1
for (line in text) {
  if (grepl('{"name"', line, fixed = TRUE)) study <- study + 1
  found <- regmatches(line, gregexpr('"n_star": [0-9]+, "a": [0-9]+, "b": [0-9]+, "test": \\[[^]]*', line))[[1]]
  for (one in found) {
    x <- as.numeric(regmatches(one, gregexpr("-?[0-9.]+(e-?[0-9]+)?", one))[[1]])
    for (id in names(claims)) for (pair in claims[[id]]) {
      sign <- if (all(x[2:3] == pair)) 1 else if (all(x[3:2] == pair)) -1 else next
      for (score in names(margins)) for (sided in c(FALSE, TRUE))
        lines <- c(lines, sprintf('{"study": %d, "id": "%s", "label": "%s - %s, %s, %s", "one_sided": %s, %s}', study, id,
          methods[pair[1] + 1], methods[pair[2] + 1], score, c("16k", "32k")[x[1] + 1], if (sided) "true" else "false",
          tested(id, score, sign * x[4], x[5], x[6], sided)))
    }
  }
}
cat(sprintf('{"r": "%s", "script": "mixed_hypotheses.R", "tests": [\n%s]}\n', R.version.string, paste(lines, collapse = ",\n")))
