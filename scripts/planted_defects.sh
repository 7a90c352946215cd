#!/usr/bin/env bash
# Plants known defects in a copy of the solver, one at a time, and runs the tests that must then fail. Prints
# a table; fails if a defect is detected by no test.
# usage: scripts/planted_defects.sh [NAME ...]   default: all
#        scripts/planted_defects.sh --list       lists the defects
#        scripts/planted_defects.sh --check      checks that each defect can still be planted and
#                                                that docs/results.md lists it; builds nothing
# The copy and its build are in build/planted and are reused. Logs go to out/planted_defects.
set -uo pipefail
cd "$(dirname "$0")/.." || exit 2
copy=build/planted out=out/planted_defects
names=() words=() files=() olds=() news=() programs=() filters=()

# defect NAME WORDS FILE PROGRAM FILTER OLD NEW [OLD NEW ...] declares a defect: OLD, which occurs exactly
# once in FILE, is replaced by NEW. Tests of PROGRAM that match FILTER must then fail.
defect() {
  local name=$1 old='' new=''
  names+=("$name") words+=("$2") files+=("$3") programs+=("$4") filters+=("$5")
  shift 5
  while [ $# -gt 0 ]; do old+=$1$'\1' new+=$2$'\1'; shift 2; done
  olds+=("$old") news+=("$new")
}
stages=libsim/solver/stages

defect pair-sign "the sign of one pair term" $stages/displacement_macklin2013.cpp sim_test 'Displacement.*' \
  'pair.mass_ratio(other.w) * own + lambda[j];' 'pair.mass_ratio(other.w) * own - lambda[j];'
defect no-wall-density "wall density left out" $stages/density_macklin2013.cpp sim_test 'Density.*' \
  'volume * rho + walls.missing(' 'volume * rho + 0 * walls.missing('
defect wall-sum "wall density summed over the walls" libsim/particles/walls.hpp sim_test 'Walls.*' \
  'present *= kept;' 'present -= 1 - kept;'
defect relaxation-unscaled "one relaxation for particles of any size" $stages/density_macklin2013.cpp sim_test 'Density.*' \
  'relaxation / (spacing * spacing);' 'relaxation / (0.15f * 0.15f + 0 * spacing);'
defect no-nan-guard "what is not finite is not quarantined" $stages/predict.cpp stability_test 'Divergence.*Lost*:Divergence.TheLowest*' \
  'if (!place_lost && all_finite(v)) return;' 'return;'
defect eased-impact "the constraint stays weakened in what strikes a wall" libsim/levels/easing.hpp sim_test 'Ease.*' \
  'impact = 0.1f' 'impact = 1e9f'
defect merged-mass "a merged particle is 1 % too heavy" libsim/levels/joining.hpp sim_test 'Account.CountsWhatIsThere' \
  'mean(velocity, kept, left), supports.h[coarser],' 'mean(velocity, kept, left), 1.00332f * supports.h[coarser],'
defect split-speed "a child's offset becomes velocity" libsim/levels/compact.cpp stability_test 'S06Conservation.One*' \
  $'  Vec4* position;\n  int* id;' $'  Vec4* position;\n  Vec4* velocity;\n  int* id;' \
  $'parent.w / 4, c), supports.h[finer]);\n' \
  $'parent.w / 4, c), supports.h[finer]);\n    velocity[i] = with_w(xyz(velocity[i]) + 60 * (xyz(position[i]) - xyz(parent)), 0);\n' \
  $'.position = p.position(),\n                         .id' \
  $'.position = p.position(),\n                         .velocity = p.velocity(),\n                         .id'
defect short-lists "no list has more than 40 neighbours" libsim/neighbors/neighbour_list.cpp stability_test 'S14NeighbourList.*' \
  'count[slot] = found;' 'count[slot] = found < 40 ? found : 40;'
defect substep-lag "substeps follow the frame before instead of the one before that" libsim/solver/substeps.hpp stability_test \
  'S09Jet.*' 'return older_;' 'return newer_;'
defect viscosity-by-step "viscosity acts once a substep, however long" $stages/xsph_monaghan1989.cpp sim_test 'Xsph.*' \
  '22 * k.viscosity * k.dt' '22 * k.viscosity / 180'
defect viscosity-by-size "viscosity acts alike on particles of any size" $stages/xsph_monaghan1989.cpp sim_test 'Xsph.*' \
  'spread * reciprocal(kernel.h2)' 'spread * 11'
defect speed-guard "the guard on speed stands at 0.5 h a substep" libsim/solver/choices.cpp stability_test 'S09Jet.*' \
  '3 * fall_speed + 3 * capillary_speed(scene.effects, d)' 'd / static_cast<double>(parameters.dt)'
defect cells-by-number "cells weigh particles by number, not by mass" $stages/coarse_pressure.cpp sim_test 'CoarsePressure.*' \
  'float volume = mass_of(p.w, 1) / unit_volume;' 'float volume = unit_volume > 0 ? 1 : 0;'
defect cells-leak "cells of a wall take part in the pressure" libsim/pressure/coarse_slope.hpp sim_test 'CoarsePressure.*' \
  'if (!walls.opening_count ||' 'if (walls.opening_count < 0 &&'
defect braked-way "the guard brakes a speed and not its way" $stages/velocity.cpp stability_test 'Divergence.AThousand*' \
  'length(after) > brake.most_speed' 'length(after) > 1e30f'

index_of() {  # index_of NAME: prints the index of the defect
  for i in "${!names[@]}"; do [ "${names[$i]}" = "$1" ] && { echo "$i"; return; }; done
  echo "planted_defects: no defect '$1'; there are: ${names[*]}" >&2
  return 1
}

planted() {  # planted I: prints the text of the file with defect I
  local text old new rest_old=${olds[$1]} rest_new=${news[$1]}
  text=$(<"${files[$1]}")
  while [ -n "$rest_old" ]; do
    old=${rest_old%%$'\1'*} new=${rest_new%%$'\1'*}
    rest_old=${rest_old#*$'\1'} rest_new=${rest_new#*$'\1'}
    local before=${text%%"$old"*} after
    [ "$before" != "$text" ] || { echo "planted_defects: ${names[$1]}: '$old' is not in ${files[$1]}" >&2; return 1; }
    after=${text#*"$old"}
    [ "${after#*"$old"}" = "$after" ] || { echo "planted_defects: ${names[$1]}: '$old' is twice in ${files[$1]}" >&2; return 1; }
    text=$before$new$after
  done
  printf '%s\n' "$text"
}

check() {
  local bad=0
  for i in "${!names[@]}"; do
    planted "$i" >/dev/null || bad=1
    grep -qF "| \`${names[$i]}\` |" docs/results.md || { echo "planted_defects: docs/results.md does not name ${names[$i]}" >&2; bad=1; }
  done
  return $bad
}

copy_sources() {  # copies the sources of the working tree, committed or not
  mkdir -p "$copy"
  find "$copy" -mindepth 1 -maxdepth 1 ! -name build -exec rm -rf {} +
  git ls-files -zco --exclude-standard | while IFS= read -r -d '' file; do [ ! -e "$file" ] || printf '%s\0' "$file"; done |
    tar --null -T - -cf - | tar -xf - -C "$copy"
  touch "${files[@]/#/$copy/}"  # forces a new compilation: an interrupted run may have compiled a defect
}
build() { cmake --build "$copy/build/dev" --target "$@" >"$log" 2>&1; }
run() {  # run PROGRAM FILTER: runs the tests of PROGRAM that match FILTER, with a time limit
  { (cd "$copy" && timeout "${VIP_PLANTED_SECONDS:-300}" "build/dev/tests/$1" --gtest_filter="$2" --gtest_brief=1); } >>"$log" 2>&1
}
row() { printf '%-20s %-58s %s\n' "$@" | tee -a "$table"; }

case ${1:-} in
  --list) for i in "${!names[@]}"; do printf '%-20s %s\n' "${names[$i]}" "${words[$i]}"; done; exit ;;
  --check) check; exit ;;
esac
chosen=()
for name in "${@:-${names[@]}}"; do i=$(index_of "$name") || exit 2; chosen+=("$i"); done
check || exit 2

mkdir -p "$out"
table=$out/table.txt log=$out/sound.log
: >"$table"
copy_sources
(cd "$copy" && cmake --preset dev -DVIP_CUDA=OFF >/dev/null) || exit 2
mapfile -t all < <(for i in "${chosen[@]}"; do echo "${programs[$i]}"; done | sort -u)
build "${all[@]}" || { tail -n 15 "$log" >&2; exit 2; }
failed=0
for program in "${all[@]}"; do  # without a defect all tests must pass
  filter=
  for i in "${chosen[@]}"; do [ "${programs[$i]}" != "$program" ] || filter+="${filters[$i]}:"; done
  run "$program" "$filter-*Gpu.*:*Slow.*" || { echo "planted_defects: tests fail without a defect: see $log" >&2; exit 2; }
done

row defect file "caught by"
for i in "${chosen[@]}"; do
  log=$out/${names[$i]}.log
  planted "$i" >"$copy/${files[$i]}"
  if ! build "${programs[$i]}"; then
    failed=1 caught="does not compile: see $log"
  else
    run "${programs[$i]}" "${filters[$i]}-*Gpu.*:*Slow.*"
    ended=$?
    caught=$(sed -nE 's/^\[  FAILED  \] ([A-Za-z0-9_]+\.[A-Za-z0-9_]+).*/\1/p' "$log" | sort -u | paste -sd' ')
    case $ended in
      0) failed=1 caught="NOBODY" ;;
      124) failed=1 caught="nobody within the time: see $log" ;;
      *) [ -n "$caught" ] || caught="a crash in $(sed -nE 's/^\[ RUN      \] (.*)/\1/p' "$log" | tail -n 1)" ;;
    esac
  fi
  row "${names[$i]}" "${files[$i]}" "$caught"
  cp "${files[$i]}" "$copy/${files[$i]}"
done
exit $failed
