//! Paths as users type, paste and drop them.

use std::path::{MAIN_SEPARATOR, Path, PathBuf};

/// Returns the home folder.
pub fn home() -> Option<PathBuf> {
    let variable = if cfg!(windows) { "USERPROFILE" } else { "HOME" };
    std::env::var_os(variable).filter(|home| !home.is_empty()).map(PathBuf::from)
}

/// Returns the path that a text means: `~` is the home folder, and `file://` begins the address of
/// a local file. Quotes around a path are left out, because shells and file managers add them.
pub fn path_of(text: &str) -> PathBuf {
    meant(text, home().as_deref())
}

fn meant(text: &str, home: Option<&Path>) -> PathBuf {
    let text = text.trim();
    let quoted = |quote: char| text.strip_prefix(quote)?.strip_suffix(quote);
    let text = quoted('"').or_else(|| quoted('\'')).unwrap_or(text);
    if let Some(path) = text.strip_prefix("file://") {
        return decoded(path.strip_prefix("localhost").unwrap_or(path));
    }
    match (text.strip_prefix('~'), home) {
        (Some(""), Some(home)) => home.to_owned(),
        (Some(rest), Some(home)) if rest.starts_with(['/', MAIN_SEPARATOR]) => home.join(&rest[1..]),
        _ => PathBuf::from(text),
    }
}

/// Decodes the bytes that an address writes as `%20`.
fn decoded(text: &str) -> PathBuf {
    let bytes = text.as_bytes();
    let (mut path, mut at) = (Vec::with_capacity(bytes.len()), 0);
    while at < bytes.len() {
        let code = text.get(at + 1..at + 3).filter(|_| bytes[at] == b'%');
        let byte = code.and_then(|code| u8::from_str_radix(code, 16).ok());
        path.push(byte.unwrap_or(bytes[at]));
        at += if byte.is_some() { 3 } else { 1 };
    }
    from_bytes(path)
}

#[cfg(unix)]
fn from_bytes(bytes: Vec<u8>) -> PathBuf {
    use std::os::unix::ffi::OsStringExt;
    PathBuf::from(std::ffi::OsString::from_vec(bytes))
}

#[cfg(not(unix))]
fn from_bytes(bytes: Vec<u8>) -> PathBuf {
    let text = String::from_utf8_lossy(&bytes).into_owned();
    // The address of C:\house.obj is file:///C:/house.obj.
    PathBuf::from(text.strip_prefix('/').unwrap_or(&text))
}

/// Splits a text at its last separator: the part that names a folder, and the beginning of a name.
pub fn split(text: &str) -> (&str, &str) {
    let at = text.rfind(['/', MAIN_SEPARATOR]).map_or(0, |at| at + 1);
    text.split_at(at)
}

/// Returns a text whose last name is replaced by a complete one.
pub fn completed(text: &str, name: &str, is_folder: bool) -> String {
    let end = if is_folder { "/" } else { "" };
    format!("{}{name}{end}", split(text).0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tilde_is_the_home_folder_and_an_address_is_a_path() {
        let home = Path::new("/home/eve");
        let of = |text: &str| meant(text, Some(home));
        assert_eq!(of("~/a b.obj"), Path::new("/home/eve/a b.obj"));
        assert_eq!(of("~"), home);
        assert_eq!(of("~other/x"), Path::new("~other/x"), "another user's home is not guessed");
        assert_eq!(of(" \"/tmp/a.obj\" "), Path::new("/tmp/a.obj"));
        assert_eq!(of("house~.obj"), Path::new("house~.obj"));
        if cfg!(unix) {
            assert_eq!(of("file:///tmp/a%20b%C3%A4.obj"), Path::new("/tmp/a bä.obj"));
            assert_eq!(of("file://localhost/tmp/100%.obj"), Path::new("/tmp/100%.obj"));
        }
        assert_eq!(meant("~/x", None), Path::new("~/x"));
    }

    #[test]
    fn a_name_is_completed_where_it_was_begun() {
        assert_eq!(completed("~/mod", "models", true), "~/models/");
        assert_eq!(completed("ho", "house.obj", false), "house.obj");
        assert_eq!(split("/tmp/a/"), ("/tmp/a/", ""));
    }
}
