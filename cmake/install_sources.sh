#!/bin/sh
# install_sources.sh FILE FOLDER: what FILE names of Debian's source packages, unpacked into FOLDER. apt gets a list of
# sources of its own and keeps its state in FOLDER, so that the system's lists stay as they are. Where the sources cannot
# be had, says why and goes on: what needs them is then not in the build.
set -euf
list=$1
if [ -f "$2/installed.txt" ] && cmp -s "$list" "$2/installed.txt"; then exit 0; fi
rm -rf "$2"
mkdir -p "$2/apt/lists/partial"
folder=$(cd "$2" && pwd)

missing() {
  echo "the sources of $list cannot be had ($1): peers compiled from them are not in this build"
  exit 0
}
mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Codename: bookworm' 2> /dev/null | head -n 1)
[ -n "$mirror" ] || missing "apt knows no mirror of bookworm"

echo "unpacking sources: $list into $folder"
keys=/usr/share/keyrings/debian-archive-keyring.gpg
echo "deb-src [signed-by=$keys] $mirror bookworm main" > "$folder/apt/sources.list"
own_apt() {
  apt-get -qq -o Dir::Etc::sourcelist="$folder/apt/sources.list" -o Dir::Etc::sourceparts=- \
    -o Dir::State::lists="$folder/apt/lists" -o Dir::Cache::pkgcache= -o Dir::Cache::srcpkgcache= \
    -o APT::Sandbox::User= "$@" > "$folder/apt/log" 2>&1
}
own_apt update || missing "apt-get update failed: $folder/apt/log"
grep -v '^#' "$list" > "$folder/apt/wanted"
while read -r package version file sum taken; do
  (cd "$folder/apt" && own_apt source --download-only "$package=$version") || missing "no $package $version: $folder/apt/log"
  echo "$sum  $folder/apt/$file" | sha256sum --check --status || missing "$file has another SHA-256"
  mkdir -p "$folder/$package"
  # shellcheck disable=SC2086  # one pattern per word
  tar -xf "$folder/apt/$file" -C "$folder/$package" --strip-components=1 --wildcards $taken
done < "$folder/apt/wanted"
rm -r "$folder/apt"
cp "$list" "$folder/installed.txt"
