#!/bin/sh
# Makes the Debian package, with manual page and completions. Needs `cargo install cargo-deb`.
set -eu
cd "$(dirname "$0")/../.."
cargo build --release --locked
program=target/release/afterimage
mkdir -p target/papers
"$program" man > target/papers/afterimage.1
"$program" completions bash > target/papers/afterimage.bash
"$program" completions zsh > target/papers/_afterimage
"$program" completions fish > target/papers/afterimage.fish
cargo deb -p afterimage-ui --no-build --output target/afterimage.deb
echo "target/afterimage.deb"
