//! When the entries of a zip file say they were written: read by hand, from APPNOTE.TXT 4.3.

/// Begins an entry of the central directory.
const CENTRAL: &[u8] = b"PK\x01\x02";
/// Begins an entry's own header.
const LOCAL: &[u8] = b"PK\x03\x04";
/// Begins the end of the central directory.
const END: &[u8] = b"PK\x05\x06";

/// Name, DOS date and DOS time of each entry, from the directory; those of the entries' own headers
/// are asserted to be the same.
pub(crate) fn npz_dates(zip: &[u8]) -> Vec<(String, u16, u16)> {
    let end = zip.windows(4).rposition(|bytes| bytes == END).expect("a zip file");
    let mut at = u32_at(zip, end + 16);
    let entry = |_| {
        assert_eq!(&zip[at..at + 4], CENTRAL);
        let (time, date) = (u16_at(zip, at + 12), u16_at(zip, at + 14));
        let lengths = [28, 30, 32].map(|field| usize::from(u16_at(zip, at + field)));
        let name = String::from_utf8_lossy(&zip[at + 46..at + 46 + lengths[0]]).into_owned();
        let local = u32_at(zip, at + 42);
        assert_eq!(&zip[local..local + 4], LOCAL);
        assert_eq!((time, date), (u16_at(zip, local + 10), u16_at(zip, local + 12)), "{name}");
        at += 46 + lengths.iter().sum::<usize>();
        (name, date, time)
    };
    (0..u16_at(zip, end + 10)).map(entry).collect()
}

fn u16_at(bytes: &[u8], at: usize) -> u16 {
    u16::from_le_bytes([bytes[at], bytes[at + 1]])
}

fn u32_at(bytes: &[u8], at: usize) -> usize {
    let bytes = [bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]];
    u32::from_le_bytes(bytes) as usize
}
