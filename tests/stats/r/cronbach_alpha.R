# Cronbach's alpha and Feldt's interval of made answers, by the ratio of mean squares of a two-way analysis of variance
# (another way than the program's). Prints cronbach_alpha.json:
#   Rscript cronbach_alpha.R > cronbach_alpha.json
set.seed(4)
num <- function(x) sprintf("%.17g", x)
list_of <- function(x) paste0("[", paste(x, collapse = ", "), "]")
study <- function(people, items, common) {
  answers <- outer(rnorm(people, sd = common), rep(1, items)) + matrix(rnorm(people * items), people)
  answers <- matrix(pmin(3, pmax(0, round(1 + answers))), people)
  long <- data.frame(score = as.vector(answers), person = factor(rep(1:people, items)),
                     item = factor(rep(1:items, each = people)))
  squares <- anova(lm(score ~ person + item, long))$"Mean Sq"
  alpha <- 1 - squares[3] / squares[1]
  f <- function(p) qf(p, people - 1, (people - 1) * (items - 1))
  sprintf('{"items": %d, "rows": %s, "alpha": %s, "low": %s, "high": %s}', items, list_of(as.vector(t(answers))),
          num(alpha), num(1 - (1 - alpha) * f(0.975)), num(1 - (1 - alpha) * f(0.025)))
}
studies <- c(study(26, 4, 1), study(26, 3, 0.5), study(8, 2, 1.5), study(40, 5, 0))
cat(sprintf('{"r": "%s", "script": "cronbach_alpha.R", "studies": [\n%s]}\n', R.version.string,
            paste(studies, collapse = ",\n")))
