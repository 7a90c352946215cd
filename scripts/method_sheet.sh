#!/bin/sh
# The five methods side by side at one frame of a scene: plain above, painted by level below.
# usage: scripts/method_sheet.sh SCENE N_STAR FRAME OUT.png [options of vip-view]
# Takes vip-view from $VIP_VIEW, else from build/release; needs ImageMagick's montage.
set -eu
if [ $# -lt 4 ]; then
  sed -n '2,4s/^# //p' "$0" >&2
  exit 2
fi
scene=$1 n_star=$2 frame=$3 out=$4
shift 4
view=${VIP_VIEW:-$(dirname "$0")/../build/release/bin/vip-view}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
plain= painted=
for method in LoRes HiRes FovFluid Ours Ours-TSp; do
  "$view" --headless "$scene" --method $method --n-star "$n_star" --overlay none,level --tau fixed:-6 \
    --frames $((frame + 1)) --every "$frame" --png "$work/$method" "$@"
  name=$work/$method/frame_$(printf %04d "$frame")
  plain="$plain -label $method $name.png"
  painted="$painted -label $method ${name}_level.png"
done
# shellcheck disable=SC2086  # words on purpose
montage $plain $painted -tile 5x2 -geometry 400x225+2+2 -pointsize 14 "$out"
