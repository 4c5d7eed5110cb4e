//! By what a place is known again.

use std::hash::Hasher;

use siphasher::sip128::{Hasher128, SipHasher13};

/// In 32 hexadecimal digits; another one for other texts, and the same on every machine. Nothing
/// that keeps secrets, or that withstands somebody who looks for two places of one fingerprint.
pub(crate) fn fingerprint(texts: &[&[u8]]) -> String {
    let mut hasher = SipHasher13::new();
    for text in texts {
        hasher.write(&(text.len() as u64).to_le_bytes());
        hasher.write(text);
    }
    let hash = hasher.finish128();
    format!("{:016x}{:016x}", hash.h1, hash.h2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_texts_have_another_fingerprint_and_the_same_have_the_same() {
        let known = fingerprint(&[b"map", b"domain"]);
        assert_eq!(known.len(), 32);
        assert_eq!(known, fingerprint(&[b"map", b"domain"]));
        assert_ne!(known, fingerprint(&[b"mapd", b"omain"]));
        assert_ne!(known, fingerprint(&[b"map", b"domain", b""]));
    }
}
