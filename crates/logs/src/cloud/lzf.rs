//! LZF, as PCD files are packed by (Lehmann, liblzf).
//!
//! ```text
//!   000LLLLL            L + 1 bytes as they are
//!   LLLooooo oooooooo   L + 2 bytes from o + 1 back, L from 1 to 6
//!   111ooooo LLLLLLLL oooooooo   the same, L + 9 bytes
//! ```

/// Of one packed byte at most so many plain ones come.
pub(super) const MOST_A_BYTE: usize = 88;

/// Unpacks to exactly so many bytes.
///
/// # Errors
/// What was found, if they are no such bytes.
pub(super) fn unpack(packed: &[u8], plain_bytes: usize) -> Result<Vec<u8>, String> {
    if plain_bytes / MOST_A_BYTE > packed.len() {
        return Err(format!("{} bytes packed into {}", plain_bytes, packed.len()));
    }
    let mut plain = Vec::with_capacity(plain_bytes);
    let mut rest = packed;
    while let Some((&control, behind)) = rest.split_first() {
        rest = step(control, behind, &mut plain).ok_or("broken packed bytes")?;
        if plain.len() > plain_bytes {
            break;
        }
    }
    match plain.len() == plain_bytes {
        true => Ok(plain),
        false => Err(format!("{} of {plain_bytes} bytes once unpacked", plain.len())),
    }
}

/// Appends what a control byte says; gives what stands behind it.
fn step<'a>(control: u8, rest: &'a [u8], plain: &mut Vec<u8>) -> Option<&'a [u8]> {
    if control < 32 {
        let (run, rest) = rest.split_at_checked(usize::from(control) + 1)?;
        plain.extend_from_slice(run);
        return Some(rest);
    }
    let (long, rest) = match control >> 5 {
        7 => rest.split_first().map(|(length, rest)| (usize::from(*length), rest))?,
        _ => (0, rest),
    };
    let (&low, rest) = rest.split_first()?;
    let length = usize::from(control >> 5) + long + 2;
    let back = (usize::from(control & 31) << 8 | usize::from(low)) + 1;
    let from = plain.len().checked_sub(back)?;
    // What is copied may reach into what is being written.
    (from..from + length).for_each(|at| plain.push(plain[at]));
    Some(rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_and_references_are_unpacked() {
        let packed = [2, b'a', b'b', b'c', 0x20, 2, 0xe0, 3, 0];
        assert_eq!(unpack(&packed, 18).unwrap(), b"abcabccccccccccccc"[..18].to_vec());
    }

    #[test]
    fn broken_bytes_are_refused() {
        for packed in
            [&[2, b'a'][..], &[0x20, 0], &[0xe0, 1], &[0, b'a', 0x20], &[0, b'a', 0x20, 9]]
        {
            assert!(unpack(packed, 6).is_err(), "{packed:?}");
        }
        assert!(unpack(&[0, b'a'], 2).is_err() && unpack(&[0, b'a'], 1 << 40).is_err());
    }
}
