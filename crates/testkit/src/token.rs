//! Row tokens: 32 hex digits, a function of the table and the row's place alone.

/// Packs a row's place into one number: the scene, a lane in it (a sensor, a track), a step.
pub(crate) fn row_key(scene: usize, lane: usize, step: usize) -> u64 {
    assert!(lane < 1 << 16 && step < 1 << 24, "lane {lane}, step {step}");
    (scene as u64) << 40 | (lane as u64) << 24 | step as u64
}

/// The token of one row.
pub(crate) fn token(table: &str, key: u64) -> String {
    let high = mix(fnv1a(table) ^ key);
    let low = mix(high ^ key);
    format!("{high:016x}{low:016x}")
}

/// The FNV-1a hash (Fowler, Noll & Vo 1991).
fn fnv1a(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

/// The output step of splitmix64 (Steele, Lea & Flood 2014), a bijection.
fn mix(seed: u64) -> u64 {
    let z = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_are_32_hex_digits_and_stay_the_same() {
        let first = token("sample", row_key(0, 0, 0));
        assert_eq!(first.len(), 32);
        assert_eq!(first, token("sample", 0));
        assert_ne!(first, token("scene", 0));
        assert_ne!(first, token("sample", row_key(0, 1, 0)));
    }
}
