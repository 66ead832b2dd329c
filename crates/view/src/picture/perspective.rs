//! Labels as lit cubes.

use image::{Rgb, RgbImage};
use nalgebra::{Point3, Rotation3, Vector3};
use occlabel_core::Pose;

use crate::picture::color::FLOOR;
use crate::picture::cubes::Cubes;
use crate::picture::gaze::{CameraGaze, Gaze};
use crate::picture::legend::Legend;
use crate::picture::lens::Lens;
use crate::picture::marks;
use crate::picture::orbit::{Aim, Orbit};
use crate::picture::overlay::CameraView;
use crate::picture::painted::{Painted, hidden};
use crate::picture::plate::{Plate, blank, body_width_px};
use crate::picture::tiles::fit;

/// The occupied voxels as lit cubes, over a floor that shows where nothing stands.
///
/// Voxels that no camera sees are dull. Pictures too narrow for a legend have none.
///
/// # Panics
/// If the grids are not of the spec's shape.
pub fn perspective(labels: &Painted, orbit: &Orbit) -> RgbImage {
    let plate = Plate { width: orbit.width, height: orbit.height, title: "" };
    let body = Orbit { width: body_width_px(orbit.width), ..*orbit };
    plate.around(&cubes(labels, &body), &legend(labels))
}

impl Plate<'_> {
    /// The occupied voxels as lit cubes, from where `aim` says, over a floor that shows where nothing
    /// stands; voxels that no camera sees are dull.
    ///
    /// # Panics
    /// If the grids are not of the spec's shape.
    pub fn perspective(&self, labels: &Painted, aim: &Aim) -> RgbImage {
        let body = cubes(labels, &aim.at(labels, self.body_px()));
        self.around(&body, &legend(labels))
    }

    /// The same as a camera sees them, its own pose and distortion included.
    ///
    /// # Panics
    /// If the grids are not of the spec's shape.
    pub fn through_camera(&self, labels: &Painted, view: &CameraView) -> RgbImage {
        labels.check();
        let room = self.body_px();
        let (width, height) = fit(view.aspect(), room);
        let mut scene = blank(width, height);
        render(labels, &view.gaze((width, height)), &mut scene);
        let mut body = blank(room.0, room.1);
        let (left, top) = ((room.0 - width.min(room.0)) / 2, (room.1 - height.min(room.1)) / 2);
        image::imageops::replace(&mut body, &scene, left.into(), top.into());
        self.around(&body, &legend(labels))
    }
}

impl CameraView<'_> {
    /// Its width by its height.
    pub(crate) fn aspect(&self) -> f64 {
        f64::from(self.camera.width.max(1)) / f64::from(self.camera.height.max(1))
    }

    pub(crate) fn gaze(&self, size: (u32, u32)) -> CameraGaze<'_> {
        let pose: &Pose = &self.grid_from_camera;
        CameraGaze::new(self.camera, pose, size)
    }
}

/// What an orbit shows of the labels, in its own size, without a legend.
pub(crate) fn cubes(labels: &Painted, orbit: &Orbit) -> RgbImage {
    labels.check();
    let lens = orbit.lens();
    let mut scene = blank(orbit.width, orbit.height);
    render(labels, &lens, &mut scene);
    mark_ego(&mut scene, &lens, labels);
    scene
}

fn render(labels: &Painted, gaze: &impl Gaze, scene: &mut RgbImage) {
    let cameras = labels.has_cameras();
    let cubes = Cubes {
        spec: labels.spec,
        solid: |flat| labels.class(flat).is_some(),
        color: |flat| color(labels, flat, cameras),
        floor: true,
        opacity: 1.0,
    };
    cubes.render(gaze, scene);
}

pub(crate) fn legend(labels: &Painted) -> Legend {
    let legend = Legend::of(labels);
    if labels.has_cameras() { legend.with_hidden() } else { legend }
}

fn color(labels: &Painted, flat: usize, cameras: bool) -> Rgb<u8> {
    let color = labels.class(flat).map_or(FLOOR, |class| labels.color(class));
    if cameras && labels.unseen(flat) { hidden(color) } else { color }
}

/// The ego on the ground; nothing if nobody tells where it points.
pub(crate) fn mark_ego(scene: &mut RgbImage, lens: &Lens, labels: &Painted) {
    let Some(heading_rad) = labels.heading_rad else { return };
    let extent_m = labels.spec.max_m() - labels.spec.min_m();
    let ego = Rotation3::from_axis_angle(&Vector3::z_axis(), heading_rad);
    let size_m = extent_m.x.max(extent_m.y) / 40.0;
    let dart = [(1.7, 0.0), (-1.0, 0.7), (-0.5, 0.0), (-1.0, -0.7)];
    let corners =
        dart.map(|(x, y)| lens.project(&(ego * Point3::new(x * size_m, y * size_m, 0.0))));
    if let [Some(nose), Some(left), Some(notch), Some(right)] = corners {
        marks::ego(scene, [nose, left, notch, right]);
    }
}
