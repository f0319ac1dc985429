//! The largest number of diffuse bounces as people write it: a whole number, or `all`.

use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt::{Display, Formatter, Result as FmtResult};
use std::str::FromStr;

/// Largest number of diffuse bounces of a path: a whole number up to [`Self::MAX_NUMBER`], or as
/// many as matter.
///
/// Flags, settings, sessions, metadata and records all write and read it through this type: as
/// `all` or as the number. [`super::TraceSettings::bounces`] holds its value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BounceLimit(
    /// Number of bounces, or [`super::TraceSettings::ALL_BOUNCES`].
    pub u32,
);

impl BounceLimit {
    /// As many bounces as matter.
    pub const ALL: Self = Self(u32::MAX);

    /// Direct light only.
    pub const NONE: Self = Self(0);

    /// Largest number that can be written.
    pub const MAX_NUMBER: u32 = 64;

    /// What can be written, in words.
    pub const EXPECTED: &str = "'all' or a whole number from 0 to 64";

    /// Word for [`Self::ALL`].
    const WORD: &str = "all";

    /// The light that paths of this limit gather, in words.
    pub fn light(self) -> String {
        match self {
            Self::NONE => "direct light only".to_owned(),
            Self::ALL => "all bounces of light".to_owned(),
            Self(1) => "one bounce of light".to_owned(),
            Self(n) => format!("{n} bounces of light"),
        }
    }
}

/// A text that is no limit of bounces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("it must be {}", BounceLimit::EXPECTED)]
pub struct NotABounceLimit;

impl FromStr for BounceLimit {
    type Err = NotABounceLimit;

    fn from_str(text: &str) -> Result<Self, NotABounceLimit> {
        if text == Self::WORD {
            return Ok(Self::ALL);
        }
        text.parse().map_err(|_| NotABounceLimit).and_then(number)
    }
}

/// The limit of a number.
fn number(number: u64) -> Result<BounceLimit, NotABounceLimit> {
    let number = u32::try_from(number).ok().filter(|n| *n <= BounceLimit::MAX_NUMBER);
    number.map(BounceLimit).ok_or(NotABounceLimit)
}

impl Display for BounceLimit {
    fn fmt(&self, f: &mut Formatter<'_>) -> FmtResult {
        if *self == Self::ALL { f.write_str(Self::WORD) } else { self.0.fmt(f) }
    }
}

impl Serialize for BounceLimit {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if *self == Self::ALL {
            serializer.serialize_str(Self::WORD)
        } else {
            serializer.serialize_u32(self.0)
        }
    }
}

impl<'de> Deserialize<'de> for BounceLimit {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(LimitVisitor)
    }
}

/// Reads a limit from a number or a text, as formats without a schema provide it.
struct LimitVisitor;

impl Visitor<'_> for LimitVisitor {
    type Value = BounceLimit;

    fn expecting(&self, f: &mut Formatter<'_>) -> FmtResult {
        f.write_str(BounceLimit::EXPECTED)
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<BounceLimit, E> {
        number(value).map_err(E::custom)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<BounceLimit, E> {
        u64::try_from(value).map_err(|_| NotABounceLimit).and_then(number).map_err(E::custom)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<BounceLimit, E> {
        text.parse().map_err(E::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::de::IntoDeserializer;
    use serde::de::value::{Error as ValueError, I64Deserializer, StrDeserializer, U64Deserializer};

    #[test]
    fn a_limit_comes_back_from_its_text() {
        for limit in (0..=BounceLimit::MAX_NUMBER).map(BounceLimit).chain([BounceLimit::ALL]) {
            assert_eq!(limit.to_string().parse(), Ok(limit));
        }
        assert_eq!(BounceLimit::ALL.to_string(), "all");
        assert_eq!(BounceLimit::ALL.0, crate::trace::TraceSettings::ALL_BOUNCES);
        for wrong in ["", "All", "65", "-1", "1.5", "4294967295", "18446744073709551616", "many"] {
            assert_eq!(wrong.parse::<BounceLimit>(), Err(NotABounceLimit), "{wrong}");
        }
        assert!(BounceLimit::EXPECTED.ends_with(&format!(" {}", BounceLimit::MAX_NUMBER)));
    }

    #[test]
    fn numbers_and_texts_are_read() {
        let unsigned: U64Deserializer<ValueError> = 3u64.into_deserializer();
        assert_eq!(BounceLimit::deserialize(unsigned), Ok(BounceLimit(3)));
        let signed: I64Deserializer<ValueError> = (-1i64).into_deserializer();
        assert!(BounceLimit::deserialize(signed).unwrap_err().to_string().contains("from 0 to 64"));
        for (text, limit) in [("all", BounceLimit::ALL), ("2", BounceLimit(2))] {
            let text: StrDeserializer<'_, ValueError> = text.into_deserializer();
            assert_eq!(BounceLimit::deserialize(text), Ok(limit));
        }
    }
}
