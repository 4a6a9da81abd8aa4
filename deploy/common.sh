# Shared by the two commands of the README. Sourced, not run.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
step() { printf '\n==> %s\n' "$*"; }

# install_packages [LIST…]: installs what deploy/packages.txt and further lists name and is not there yet.
install_packages() {
  local missing=() package
  for package in $(grep -hv '^#' "$root/deploy/packages.txt" "$@"); do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
  done
  if [ ${#missing[@]} = 0 ]; then
    step "Debian packages: all there"
    return
  fi
  step "Debian packages: installing ${#missing[@]}: ${missing[*]}"
  local as_root=()
  [ "$(id -u)" = 0 ] || as_root=(sudo)
  "${as_root[@]}" apt-get update -q
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${missing[@]}"
}

# build TARGETS…: configures the release preset once and builds (everything without targets).
build() {
  # Another clone of the same sources, wherever it lies, finds what this one has compiled.
  export CCACHE_BASEDIR="${CCACHE_BASEDIR:-$root}" CCACHE_NOHASHDIR="${CCACHE_NOHASHDIR:-1}"
  step "Building into build/ ($(nproc) cores; ccache makes the next time short)"
  cd "$root"
  cmake --preset release >"$root/.configure.log" 2>&1 || { cat "$root/.configure.log" >&2; exit 1; }
  rm -f "$root/.configure.log"
  cmake --build --preset release -- "$@"
}
