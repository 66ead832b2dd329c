//! The calibrations of a sequence, as YAML.

use occlabel_core::{Camera, Fault, SweepHeader};

use crate::Drive;
use crate::write::files::Output;

/// Writes lens and mounting of the cameras of these numbers.
pub(super) fn write(
    drive: &Drive,
    cameras: &[usize],
    sweep: &SweepHeader,
    output: &Output,
) -> Result<(), Fault> {
    let scene = drive.scene();
    for (number, &camera) in cameras.iter().enumerate() {
        let file = |of: String| format!("calibrations/{}/calib_{of}.yaml", scene.name);
        let lens = lens_text(&scene.cameras[camera].camera);
        output.write(&file(format!("cam{number}_intrinsics")), lens.as_bytes())?;
        let camera_from_lidar =
            drive.poses().ego_from_camera[camera].inverse() * sweep.ego_from_lidar;
        let rows = camera_from_lidar.to_homogeneous().transpose();
        let mounting = matrix_text("extrinsic_matrix", [4, 4], rows.as_slice());
        output.write(&file(format!("os1_to_cam{number}")), mounting.as_bytes())?;
    }
    Ok(())
}

fn lens_text(camera: &Camera) -> String {
    let matrix = camera.model.intrinsics().map(|lens| lens.matrix()).unwrap_or_default();
    let mut distortion = camera.model.coefficients();
    distortion.resize(distortion.len().max(5), 0.0);
    let kind = if distortion.len() > 5 { "rational_polynomial" } else { "plumb_bob" };
    let [width, height] = [camera.width, camera.height];
    format!("image_width: {width}\nimage_height: {height}\ndistortion_model: {kind}\n")
        + &matrix_text("camera_matrix", [3, 3], matrix.as_flattened())
        + &matrix_text("distortion_coefficients", [1, distortion.len()], &distortion)
}

/// A matrix by rows, each number with all its digits.
fn matrix_text(name: &str, [rows, columns]: [usize; 2], numbers: &[f64]) -> String {
    let numbers: Vec<String> = numbers.iter().map(|number| format!("{number:?}")).collect();
    let data = numbers.join(", ");
    format!("{name}:\n  rows: {rows}\n  cols: {columns}\n  data: [{data}]\n")
}
