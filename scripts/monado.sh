#!/usr/bin/env bash
# Runs ViP-Lab on Monado, an OpenXR runtime that others wrote: makes a Debian sid with Monado's service in a
# folder of its own, plays sessions on both of Monado's compositors with both bindings of OpenGL, kills the
# program and the service in mid-session, and prints a table. The headset is Monado's simulated one.
# usage: scripts/monado.sh [FOLDER]     default: out/monado. Needs root, a network and some ten minutes.
# Takes the programs from $VIP_BUILD (default: build/dev). The Debian in FOLDER is kept for the next run.
# Exit status 1: a row did not end as expected. 77: nothing was tried; the reason is printed.
set -uo pipefail
cd "$(dirname "$0")/.." || exit 2
here=$PWD
skip() { echo "monado: not tried: $*"; exit 77; }
[ "$(id -u)" -eq 0 ] || skip "making a root folder for another system needs root"
command -v debootstrap >/dev/null || skip "debootstrap is missing (apt-get install debootstrap)"
build=$(realpath "${VIP_BUILD:-build/dev}")
[ -x "$build/bin/vip-study" ] && [ -x "$build/bin/vip-view" ] || skip "$build has no vip-study and vip-view; build them, or set VIP_BUILD"

# Starts itself again in namespaces of its own: its mounts end with it, and it kills its own processes alone.
[ -n "${VIP_OWN_MOUNTS:-}" ] || exec env VIP_OWN_MOUNTS=1 unshare --mount --pid --fork --mount-proc "$0" "$@"
out=$(realpath -m "${1:-out/monado}")
root=$out/root
mkdir -p "$out"
rm -rf "$out/logs"
mkdir "$out/logs"

inside() { chroot "$root" env -i PATH=/usr/bin:/bin:/usr/sbin:/sbin DEBIAN_FRONTEND=noninteractive "$@"; }
if [ ! -e "$root/complete" ]; then
  rm -rf --one-file-system "$root"
  debootstrap --variant=minbase sid "$root" http://deb.debian.org/debian >"$out/logs/debootstrap" 2>&1 ||
    skip "debootstrap found no Debian: $(tail -1 "$out/logs/debootstrap")"
  cp /etc/apt/apt.conf.d/* "$root/etc/apt/apt.conf.d/" 2>/dev/null || true
fi
mount --rbind --make-rslave /proc "$root/proc"
mount --rbind --make-rslave /dev "$root/dev"
if [ ! -e "$root/complete" ]; then
  inside apt-get install -y --no-install-recommends monado-service libopenxr1-monado libopenxr-loader1 libegl1 libgl1 libopengl0 \
    libgl1-mesa-dri libegl-mesa0 libglx-mesa0 mesa-vulkan-drivers xvfb procps sqlite3 >"$out/logs/apt" 2>&1 ||
    skip "Monado could not be installed: $(tail -1 "$out/logs/apt")"
  : >"$root/complete"
fi
# The project is seen at its own place, read and write. Libraries that sid has in other versions come from here.
mkdir -p "$root$here" "$root/vip" "$root/run/xr"
mount --bind "$here" "$root$here"
case $build in "$here"/*) ;; *) mkdir -p "$root$build" && mount --bind "$build" "$root$build" ;; esac
rm -rf "$root/vip/lib"
mkdir -p "$root/vip/lib"
known=$(inside ldconfig -p | awk '{ print $1 }')
for program in vip-study vip-view; do
  ldd "$build/bin/$program" | awk '$3 ~ /^\// { print $3 }' | while read -r library; do
    grep -qxF "$(basename "$library")" <<<"$known" || cp -n "$library" "$root/vip/lib/"
  done
done

work=$root/run/xr/work  # files of the sessions
program() {  # program ARGUMENT ...: runs a program in the Debian, on the service, for two minutes at most
  inside env XDG_RUNTIME_DIR=/run/xr HOME=/run/xr LD_LIBRARY_PATH=/vip/lib DISPLAY=:77 OMP_WAIT_POLICY=passive \
    VIP_OPENXR_GRAPHICS="$graphics" VIP_CACHE_DIR=/run/xr/cache sh -c "cd $here && exec timeout -k 5 120 \"\$@\"" sh "$@"
}
study() { program "$build/bin/vip-study" "$@"; }

start_service() {  # starts Monado with $compositor and waits for its socket
  rm -f "$root/run/xr/monado_comp_ipc"
  local how=XRT_COMPOSITOR_FORCE_XCB=1
  [ "$compositor" = main ] || how=XRT_COMPOSITOR_NULL=1
  tail -f /dev/null | inside env XDG_RUNTIME_DIR=/run/xr HOME=/run/xr SIMULATED_ENABLE=1 DISPLAY=:77 $how \
    VK_DRIVER_FILES=/usr/share/vulkan/icd.d/lvp_icd.json monado-service >>"$out/logs/service.$compositor" 2>&1 &
  for _ in $(seq 100); do
    [ -S "$root/run/xr/monado_comp_ipc" ] && inside pgrep -x monado-service >/dev/null && sleep 2 && return
    sleep 0.1
  done
  echo "monado: the service does not start; see $out/logs/service.$compositor" >&2
  return 1
}
stop_service() {
  pkill "$@" -x monado-service
  for _ in $(seq 100); do pgrep -x monado-service >/dev/null || break; sleep 0.1; done
  pkill -P $$ -x tail
}
leave() { stop_service -KILL; pkill -f 'Xvfb :77'; }
trap leave EXIT
inside Xvfb :77 -screen 0 1280x720x24 >"$out/logs/xvfb" 2>&1 &

failed=0
table=$out/table.txt
version=$(inside dpkg-query -W -f '${Version}' monado-service)
printf 'Monado %s, %s\n\n%-10s %-5s %-44s %-7s %s\n' "$version" "$(date -u +%F)" compositor GL what ends seconds >"$table"
row() {  # row WHAT WANTED GOT: adds a line to the table; GOT is "ok" or what was found instead
  local ends=ok
  [ "$2" = "$3" ] || { ends="FAILED: $3 instead of $2"; failed=1; }
  printf '%-10s %-5s %-44s %-7s %d\n' "$compositor" "$graphics" "$1" "$ends" $((SECONDS - since)) | tee -a "$table"
  since=$SECONDS
}
ask() { inside sqlite3 "/run/xr/work/$1.db" "$2"; }
# run NAME PROTOCOL [OPTION ...]: a session of a simulated observer in real time; $? is that of vip-study
run() {
  local name=$1 protocol=$2
  shift 2
  study run "$protocol" --db "/run/xr/work/$name.db" --participants 1 --observer random --display openxr --clock real --events "$@" \
    >"$out/logs/$compositor.$graphics.$name" 2>&1
}
left_of() { ask "$1" "select count(*) from unit where state <> 'done'"; }
twice_of() { ask "$1" "select count(*) from (select 1 from response where attempt > 0 group by unit_id, question_id having count(*) > 1)"; }
resume() {  # resume NAME WHAT: resumes a session and adds the row WHAT
  study resume --db "/run/xr/work/$1.db" >"$log.$1.resume" 2>&1
  row "$2" "0, 0 left, 0 twice" "$?, $(left_of "$1") left, $(twice_of "$1") twice"
}
until_playing() {  # until_playing NAME: waits until the second trial of a session is shown
  for _ in $(seq 300); do
    [ "$(grep -c '^begins .* stimulus' "$log.$1" 2>/dev/null)" -ge 2 ] && sleep 1.5 && return
    sleep 0.1
  done
}

try_all() {  # plays all rows on $compositor and $graphics
  since=$SECONDS log=$out/logs/$compositor.$graphics
  rm -rf "$work"
  mkdir -p "$work"
  # The null compositor has 20 Hz: it shows these rates, and the methods at their own speed.
  sed -e 's/^mean_fps = .*/mean_fps = [10, 20]/' -e 's/^sd_fps = .*/sd_fps = [0]/' -e 's/^n_star = .*/n_star = ["64"]/' \
    -e 's/^accept_approximate = .*/accept_approximate = true/' protocols/ptpe_pilot.toml >"$work/pilot.toml"
  for task in task1 task2; do  # one scene, two methods
    sed -e '/{scene = .*\(jet_impact\|faucet\|"16k"\|"LoRes"\|"FovFluid"\|"Ours-TSp"\)/d' -e 's/^scene = .*/scene = ["data\/scenes\/single_dam.toml"]/' \
      -e 's/^method = .*/method = ["Ours", "HiRes"]/; s/^n_star = .*/n_star = ["64"]/; s/"32k"/"64"/; s/^groups = .*/groups = 1/; s/^timing = .*/timing = "native"/' \
      -e 's/black 5/black 0.5/; s/rest 30/rest 1/; s/rest 60/rest 1/; s/seconds = 5$/seconds = 1/; /^between_groups_s/d' \
      "protocols/$task.toml" >"$work/$task.toml"
  done

  study headset --show 2 >"$log.show" 2>&1
  row "test scene" "0, shown" "$?, $(grep -q '^ended .*after the time' "$log.show" && echo shown)"

  study bake data/scenes/single_dam.toml --method HiRes --n-star 64 --frames 60 --out /run/xr/work/dam.bake >"$log.bake" 2>&1
  dam=(--stimulus /run/xr/work/dam.bake)
  run pilot /run/xr/work/pilot.toml "${dam[@]}" --trial-seconds 2
  row "pilot" "0, 0 left" "$?, $(left_of pilot) left"

  for task in task1 task2; do
    run "$task" "/run/xr/work/$task.toml" --accept-slow --trial-seconds 2 --gaze head
    row "$task, live fluid" "0, 0 left" "$?, $(left_of "$task") left"
  done

  program "$build/bin/vip-view" data/scenes/single_dam.toml --display openxr --method HiRes --n-star 64 --frames 40 >"$log.view" 2>&1
  row "viewer" 0 $?

  local person=("$build/bin/vip-study" run /run/xr/work/pilot.toml --db /run/xr/work/person.db --participant P01 --display openxr
    --answer keyboard "${dam[@]}" --trial-seconds 1)
  program "${person[@]}" </dev/null >"$log.no_keys" 2>&1
  row "person without hand and terminal: an error" "1, 1 mend" "$?, $(grep -c '^  mend: ' "$log.no_keys") mend"
  # Presses 1 and Enter by turns: agreement, then an answer, on each page.
  (for _ in $(seq 200); do sleep 0.3; printf 1; sleep 0.3; printf '\r'; done) |
    program script -qec "${person[*]}" /dev/null >"$log.person" 2>&1
  row "person at the keyboard" "0, 0 left" "${PIPESTATUS[1]}, $(left_of person) left"

  run killed /run/xr/work/pilot.toml "${dam[@]}" --trial-seconds 4 &
  until_playing killed
  pkill -KILL -x vip-study
  wait $!
  resume killed "killed in a trial, then resumed"

  run stopped /run/xr/work/pilot.toml "${dam[@]}" --trial-seconds 4 &
  until_playing stopped
  stop_service -TERM
  wait $!
  # Monado may let the program end first.
  local stopped=$? mends finished=0
  mends=$(grep -c '^  mend: .*vip-study resume' "$log.stopped")
  [ $stopped -eq 0 ] && [ "$(left_of stopped)" = 0 ] && finished=1
  [ $stopped -eq 1 ] && [ "$mends" = 1 ] && finished=1
  row "service asked to stop: error, or finished" 1 $finished
  start_service
  resume stopped "service started again, then resumed"

  run service /run/xr/work/pilot.toml "${dam[@]}" --trial-seconds 4 &
  until_playing service
  stop_service -KILL
  wait $!
  row "service killed in a trial: an error" "1, 1 mend" "$?, $(grep -c '^  mend: .*vip-study resume' "$log.service") mend"
  start_service
  resume service "service started again, then resumed"

  run two /run/xr/work/pilot.toml "${dam[@]}" --trial-seconds 4 &
  until_playing two
  study headset --show 1 >"$log.second" 2>&1
  local second=$?
  wait $!
  row "a second program in a trial" "0, 0 left, second 0" "$?, $(left_of two) left, second $second"
}

for compositor in null main; do
  for graphics in egl xlib; do
    start_service || { failed=1; continue; }
    try_all
    stop_service -TERM
  done
done
cat "$table"
exit $failed
