//! Class masks of exposures, beside a log.

use image::ExtendedColorType;
use occlabel_core::Fault;

use crate::write::exposures::exposures;
use crate::write::files::Output;
use crate::write::png::png;
use crate::write::written::Images;
use crate::{ClassImage, Drive, render};

/// Writes what the pixels of exposures show as `masks/<scene>/<camera>/<time in ns>.png`, and their
/// instances beside; gives the number of exposures.
///
/// # Errors
/// If a file cannot be written.
pub fn write_masks(drive: &Drive, images: Images, output: &Output) -> Result<usize, Fault> {
    let scene = drive.scene();
    let mut count = 0;
    for (camera, named) in scene.cameras.iter().enumerate() {
        for exposure in exposures(drive, camera, images) {
            let stem = format!("masks/{}/{}/{}", scene.name, named.name, exposure.time.0);
            write_mask(&render(drive, &exposure), &stem, output)?;
            count += 1;
        }
    }
    Ok(count)
}

/// Writes classes and instances of a picture, 255 and 0 where there are none.
pub(crate) fn write_mask(image: &ClassImage, stem: &str, output: &Output) -> Result<(), Fault> {
    let size = [image.width, image.height];
    // The encoder takes numbers of 16 bits in the machine's own order.
    let instances: Vec<u8> = image.instances.iter().flat_map(|id| id.to_ne_bytes()).collect();
    output.write(&format!("{stem}.png"), &png(&image.classes, size, ExtendedColorType::L8))?;
    output.write(&format!("{stem}.instances.png"), &png(&instances, size, ExtendedColorType::L16))
}
