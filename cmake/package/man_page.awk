# Makes a manual page from the --help of a program or of one of its commands.
# usage: COMMAND --help | awk -v name="vip-study run" -v version=0.1.0 -v date=2026-01-31 -v see="vip-study" -f man_page.awk
function escaped(text) {
  gsub(/\\/, "\\e", text)
  gsub(/-/, "\\-", text)
  if (text ~ /^[.']/) text = "\\&" text
  return text
}
function section(title) { print ".SH " toupper(escaped(title)) }

NR == 1 {
  page = name
  gsub(/ /, "-", page)
  print ".TH \"" toupper(escaped(page)) "\" 1 \"" date "\" \"ViP-Lab " version "\" \"ViP-Lab\""
  section("Name")
  print escaped(page) " \\- " escaped($0)
  next
}
/^Usage: / {
  section("Synopsis")
  print escaped(substr($0, 8))
  next
}
/^ *\[/ {  # the heading of a group of options
  gsub(/^ *\[(Option Group: )?|\]$/, "")
  if (/^formats|^[a-z ]+$/) section($0)
  else print ".PP\n" escaped($0)
  ended = 0
  next
}
/^ *Options:$/ && grouped++ && /^ / { next }  # the heading "Options:" within such a group
/^[A-Z].*:$/ && length($0) < 40 {  # a heading: "Options:" or the name of a group
  section(substr($0, 1, length($0) - 1))
  ended = 0
  next
}
/^  +[^ ]/ && match($0, /^ +/) && RLENGTH < 6 {  # an option, usually followed by its meaning
  sub(/^ +/, "")
  what = ""
  if (match($0, /   *[^ ]/)) {
    what = substr($0, RSTART + RLENGTH - 1)
    $0 = substr($0, 1, RSTART - 1)
  }
  print ".TP\n.B " escaped($0)
  if (what != "") print escaped(what)
  next
}
/^  +[^ ]/ {
  sub(/^ +/, "")
  print escaped($0)
  next
}
/^ *$/ { next }
{  # text after the options
  if (!ended++) section("Notes")
  print escaped($0)
}
END {
  section("See also")
  print ".BR " escaped(see) " (1)"
  print ".PP\nThe pages of ViP\\-Lab stand in its share folder, /usr/share/vip\\-lab/docs when it was installed as a package."
}
