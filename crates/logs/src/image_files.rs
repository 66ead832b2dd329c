//! Images: no label needs them, so `check` reads only their headers, and `view` their bytes.

use std::io::{BufReader, ErrorKind};
use std::path::Path;

use imagesize::ImageError;
use occlabel_core::Fault;
use occlabel_disk::File;

use crate::files::{name_defect, open_file, read_file};

/// The file of an image, and what a table says about it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImageFile {
    /// Its path below the log's root, as the table names it.
    pub file: String,
    /// Width and height, pixels.
    pub size: [u32; 2],
}

/// What is odd about image files: names that lead out of the root, headers without a size, sizes that
/// the tables do not tell. Absent ones are told once, with how many there are. No pixel is decoded.
pub fn check_images(root: &Path, images: &[ImageFile]) -> Vec<Fault> {
    let (mut odd, mut absent) = (Vec::new(), Vec::new());
    for image in images {
        match image.check(root) {
            Ok(()) => {}
            Err(fault) if fault.rule == "missing-file" => absent.push(image),
            Err(fault) => odd.push(fault),
        }
    }
    if let Some(first) = absent.first() {
        let found = format!("{} of {} absent", absent.len(), images.len());
        odd.push(Fault::new("image-absent", &first.file, "image files", found));
    }
    odd
}

/// The bytes of an image file below the log's root; `None` if it is absent.
///
/// # Errors
/// If its name leads out of the root, or it cannot be read.
pub(crate) fn read_image_file(root: &Path, file: &str) -> Result<Option<Vec<u8>>, Fault> {
    if let Some(defect) = name_defect(file) {
        let found = format!("`{file}`, {defect}");
        return Err(Fault::new("file-name", file, "a path below the log's root", found));
    }
    match read_file(root, file) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(fault) if fault.rule == "missing-file" => Ok(None),
        Err(fault) => Err(fault),
    }
}

impl ImageFile {
    fn check(&self, root: &Path) -> Result<(), Fault> {
        if let Some(defect) = name_defect(&self.file) {
            let found = format!("`{}`, {defect}", self.file);
            return Err(Fault::new("file-name", &self.file, "a path below the log's root", found));
        }
        let file = open_file(&root.join(&self.file), &self.file)?;
        let expected = format!("an image of {} x {} pixels", self.size[0], self.size[1]);
        match header_size(file) {
            Ok(size) if size == self.size.map(u64::from) => Ok(()),
            Ok([width, height]) => {
                let found = format!("{width} x {height} pixels");
                Err(Fault::new("image-size", &self.file, expected, found))
            }
            Err(found) => Err(Fault::new("image-header", &self.file, expected, found)),
        }
    }
}

/// Width and height by the header; what was found instead, if it tells none.
fn header_size(file: File) -> Result<[u64; 2], String> {
    let bytes = file.size_bytes().unwrap_or(0);
    let size = imagesize::reader_size(BufReader::new(file)).map_err(|error| match error {
        ImageError::IoError(error) if error.kind() == ErrorKind::UnexpectedEof => {
            format!("the end of the file at byte {bytes}")
        }
        error => error.to_string(),
    })?;
    Ok([size.width as u64, size.height as u64])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A JPEG of 1600 x 900, cut off where its pixels would begin.
    const JPEG: &[u8] = &[
        0xff,
        0xd8,
        0xff,
        0xe0,
        0,
        16,
        b'J',
        b'F',
        b'I',
        b'F',
        0,
        1,
        1,
        0,
        0,
        1,
        0,
        1,
        0,
        0,
        0xff,
        0xc0,
        0,
        11,
        8,
        900_u16.to_be_bytes()[0],
        900_u16.to_be_bytes()[1],
        1600_u16.to_be_bytes()[0],
        1600_u16.to_be_bytes()[1],
        1,
        1,
        0x11,
        0,
    ];

    #[test]
    fn fault_30_a_truncated_image_is_fine_if_its_header_tells_the_tables_size() {
        let root = tempfile::tempdir().unwrap();
        let image = |file: &str, size| ImageFile { file: file.into(), size };
        std::fs::write(root.path().join("whole.jpg"), JPEG).unwrap();
        std::fs::write(root.path().join("cut.jpg"), &JPEG[..22]).unwrap();
        std::fs::write(root.path().join("none.jpg"), "no image at all").unwrap();
        let images = [
            image("whole.jpg", [1600, 900]),
            image("whole.jpg", [800, 450]),
            image("cut.jpg", [1600, 900]),
            image("none.jpg", [1600, 900]),
            image("absent.jpg", [1, 1]),
            image("../whole.jpg", [1600, 900]),
            image("absent.png", [1, 1]),
        ];
        assert!(check_images(root.path(), &images[..1]).is_empty());
        let faults = check_images(root.path(), &images);
        let rules: Vec<_> = faults.iter().map(|fault| fault.rule).collect();
        let headers = ["image-header", "image-header"];
        assert_eq!(rules, ["image-size", headers[0], headers[1], "file-name", "image-absent"]);
        assert_eq!(faults[0].found, "1600 x 900 pixels");
        assert_eq!(faults[1].found, "the end of the file at byte 22");
        assert_eq!(faults[4].found, "2 of 7 absent");
    }
}
