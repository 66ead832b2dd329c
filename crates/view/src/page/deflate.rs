//! Bytes made small, as a browser's `DecompressionStream("deflate")` undoes it (RFC 1950).

use zlib_rs::{DeflateConfig, ReturnCode, Strategy, compress_bound, compress_slice};

/// Bytes with repeats in them.
pub(crate) fn deflate(bytes: &[u8]) -> Vec<u8> {
    compress(bytes, Strategy::Default)
}

/// Bytes that are noise of uneven frequencies. Repeats in noise are short and by chance: to name them
/// costs more than to write them again.
pub(crate) fn deflate_noise(bytes: &[u8]) -> Vec<u8> {
    compress(bytes, Strategy::HuffmanOnly)
}

fn compress(bytes: &[u8], strategy: Strategy) -> Vec<u8> {
    let config = DeflateConfig { level: 9, mem_level: 9, strategy, ..Default::default() };
    let mut out = vec![0; compress_bound(bytes.len())];
    let (written, code) = compress_slice(&mut out, bytes, config);
    assert_eq!(code, ReturnCode::Ok, "room for all that deflating can make");
    let length = written.len();
    out.truncate(length);
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use zlib_rs::{InflateConfig, decompress_slice};

    #[test]
    fn what_was_deflated_comes_back() {
        let noise: Vec<u8> =
            (0..5000_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 28) as u8).collect();
        for bytes in [&b""[..], b"a", &noise] {
            for small in [deflate(bytes), deflate_noise(bytes)] {
                let mut back = vec![0; bytes.len() + 1];
                let (back, code) = decompress_slice(&mut back, &small, InflateConfig::default());
                assert_eq!((&*back, code), (bytes, ReturnCode::Ok));
            }
        }
    }
}
