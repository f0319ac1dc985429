#!/bin/sh
# Builds the Debian package with manual page and shell completions. Requires `cargo install cargo-deb`.
set -eu
cd "$(dirname "$0")/../../.."
cargo build --release --locked
program=target/release/afterimage
mkdir -p target/generated
"$program" man > target/generated/afterimage.1
"$program" completions bash > target/generated/afterimage.bash
"$program" completions zsh > target/generated/_afterimage
"$program" completions fish > target/generated/afterimage.fish
cargo deb -p afterimage-ui --no-build --output target/afterimage.deb
echo "target/afterimage.deb"
