#!/usr/bin/env bash
# Packs a build and tries the package in a clean Debian: installs it, runs the whole workflow without a
# compiler, and removes it.
# usage: scripts/package.sh [BUILD]     default: build/package, which `cmake --workflow --preset package` makes
# Exit status 77: the package was not tried; the reason is printed.
set -euo pipefail
cd "$(dirname "$0")/.."
build=$(realpath "${1:-build/package}")
skip() { echo "package: not tried: $*"; exit 77; }
[ "$(id -u)" -eq 0 ] || skip "making a root folder for another system needs root"
command -v debootstrap >/dev/null || skip "debootstrap is missing (apt-get install debootstrap)"
command -v dpkg-shlibdeps >/dev/null || skip "dpkg-shlibdeps is missing (apt-get install dpkg-dev)"
command -v file >/dev/null || skip "file is missing (apt-get install file)"
grep -q '^VIP_NATIVE:BOOL=OFF' "$build/CMakeCache.txt" || skip "$build is missing or for this processor alone (VIP_NATIVE); run cmake --workflow --preset package"

# Starts itself again in a mount namespace of its own, so that its mounts end with it.
[ -n "${VIP_OWN_MOUNTS:-}" ] || exec env VIP_OWN_MOUNTS=1 unshare --mount "$0" "$build"
work=$(mktemp -d)
root=$work/root
mounted=()
clean_up() {
  for place in "${mounted[@]}"; do umount -R "$place"; done
  rm -rf --one-file-system "$work"
}
trap clean_up EXIT

(cd "$work" && cpack -G DEB -B "$work/packages" --config "$build/CPackConfig.cmake")
package=$(find "$work/packages" -maxdepth 1 -name '*.deb')
dpkg-deb --info "$package"

suite=$(. /etc/os-release && echo "$VERSION_CODENAME")
mirror=$(apt-get indextargets --format '$(SITE) $(RELEASE)' 'Created-By: Packages' | awk -v suite="$suite" '$2 == suite { print $1; exit }')
debootstrap --variant=minbase "$suite" "$root" ${mirror:+"$mirror"} >"$work/debootstrap.log" 2>&1 ||
  skip "debootstrap found no Debian: $(tail -1 "$work/debootstrap.log")"
for place in proc dev; do
  mount --rbind --make-rslave "/$place" "$root/$place" && mounted+=("$root/$place")
done
study=/home/study
mkdir -p "$root$study"
inside() { chroot "$root" env -i PATH=/usr/bin:/bin:/usr/sbin:/sbin HOME="$study" DEBIAN_FRONTEND=noninteractive "$@"; }

# Installs the package with its dependencies and removes the package alone. Then lists all files, which must
# be the same after the package was installed again and removed.
cp "$package" "$root/tmp/vip-lab.deb"
cp /etc/apt/apt.conf.d/* "$root/etc/apt/apt.conf.d/" 2>/dev/null || true
inside apt-get update -qq
inside apt-get install -y -qq --no-install-recommends /tmp/vip-lab.deb fonts-dejavu-core >"$work/apt.log" 2>&1 ||
  { tail "$work/apt.log"; exit 1; }
inside dpkg --purge vip-lab
files() { inside find / -xdev ! -path '/tmp/*' ! -path '/proc/*' ! -path '/dev/*' ! -path '/var/lib/dpkg/*' ! -path '/var/log/*' ! -path '/var/cache/*' | sort; }
files >"$work/before"
inside dpkg --install /tmp/vip-lab.deb
! inside sh -c 'command -v cc || command -v c++ || command -v cmake' || { echo "package: the root has a compiler" >&2; exit 1; }

# Runs the whole workflow in a user's home, from a protocol to the fitted model that the solver reads, a
# report and pictures.
run() { printf '\n$ %s\n' "$*"; inside sh -c "cd $study && exec \"\$@\"" sh "$@"; }
run vip-study --version
run vip-study check ptpe_pilot --refresh 90
run vip-study run ptpe_pilot --db study.db --participants 16 --observer ptpe:a=24,b=0.02 --seed 7
run vip-stats fit-ptpe study.db --level 4 --out fitted.toml --json fit.json --svg heat.svg
run vip-stats preregister task1 task2 --out bundle
run vip-stats report study.db --html report.html
run vip-view --headless data/scenes/single_dam.toml --n-star 64 --frames 2 --size 64x36 --png pictures --ptpe fitted.toml
for made in study.db fitted.toml fit.json heat.svg bundle report.html pictures/frame_0000.png; do
  [ -s "$root$study/$made" ] || { echo "package: $made was not made" >&2; exit 1; }
done
for page in vip-study vip-study-run vip-stats-fit-ptpe vip-bench-frame vip-view; do
  [ -s "$root/usr/share/man/man1/$page.1.gz" ] || { echo "package: no manual page of $page" >&2; exit 1; }
done

inside dpkg --remove vip-lab
# The OpenGL driver caches shaders in root's home (from the password file), so that hidden files there are
# allowed.
files | grep -v -e "^$study" -e '^/root/\.' >"$work/after" || true
left=$(comm -13 "$work/before" "$work/after")
[ -z "$left" ] || { printf 'package: dpkg --remove left:\n%s\n' "$left" >&2; exit 1; }
[ -s "$root$study/study.db" ] || { echo "package: dpkg --remove took the data" >&2; exit 1; }
echo "package: installed, used and removed; the data stayed"
