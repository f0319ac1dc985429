//! The addresses in a glTF file: `data:` with base64, and file names with sequences like `%20`.

/// Returns the bytes of a `data:` address; `None` for another address, `Some(None)` where it cannot
/// be decoded.
pub(super) fn data(uri: &str) -> Option<Option<Vec<u8>>> {
    let rest = uri.strip_prefix("data:")?;
    let encoded = rest.split_once(',').filter(|(kind, _)| kind.ends_with(";base64"));
    Some(encoded.and_then(|(_, encoded)| base64(encoded)))
}

/// Decodes base64 with or without padding. White space is ignored.
fn base64(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(text.len() / 4 * 3 + 3).ok()?;
    let (mut held, mut bits) = (0u32, 0);
    for byte in text.trim_end_matches('=').bytes().filter(|b| !b.is_ascii_whitespace()) {
        let value = match byte {
            b'A'..=b'Z' => byte - b'A',
            b'a'..=b'z' => byte - b'a' + 26,
            b'0'..=b'9' => byte - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            _ => return None,
        };
        held = (held << 6) | u32::from(value);
        bits += 6;
        if bits >= 8 {
            bits -= 8;
            bytes.push((held >> bits) as u8);
        }
    }
    Some(bytes)
}

/// Returns the file name of an address: `%` sequences are decoded, invalid ones stay as they are.
pub(super) fn file_name(uri: &str) -> String {
    let bytes = uri.as_bytes();
    let hex = |at: usize| char::from(*bytes.get(at)?).to_digit(16);
    let (mut decoded, mut at) = (Vec::with_capacity(bytes.len()), 0);
    while at < bytes.len() {
        match (bytes[at], hex(at + 1), hex(at + 2)) {
            (b'%', Some(high), Some(low)) => {
                decoded.push((high * 16 + low) as u8);
                at += 3;
            }
            (byte, ..) => {
                decoded.push(byte);
                at += 1;
            }
        }
    }
    String::from_utf8(decoded).unwrap_or_else(|_| uri.to_owned())
}
