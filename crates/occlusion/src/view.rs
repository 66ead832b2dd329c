//! Which voxels a camera has in view.

use nalgebra::{Matrix3, Point3, Vector3};
use occlabel_core::camera::{CameraModel, Intrinsics};
use occlabel_core::{Camera, GridSpec, VoxelGrid, VoxelIndex};

use crate::Eye;

/// What lies outside a camera's field of view by this, for each metre of distance and one more, is
/// so without asking the model; far above the rounding of f64.
const CLEARLY: f64 = 1e-6;

/// What a camera has in view, in the grid frame.
pub(crate) struct View<'a> {
    camera: &'a Camera,
    position: Point3<f64>,
    camera_from_grid: Matrix3<f64>,
    depth_max_m: f64,
    /// Unit normals of planes through the camera: it sees nothing on their negative side.
    bounds: Vec<Vector3<f64>>,
}

impl<'a> View<'a> {
    pub(crate) fn new(eye: &Eye<'a>, depth_max_m: f64) -> Self {
        let camera_from_grid = eye.grid_from_camera.rotation.inverse().to_rotation_matrix();
        let grid_from_camera = camera_from_grid.inverse();
        let bounds = bounds(eye.camera).into_iter().map(|normal| grid_from_camera * normal);
        Self {
            camera: eye.camera,
            position: eye.position(),
            camera_from_grid: camera_from_grid.into_inner(),
            depth_max_m,
            bounds: bounds.collect(),
        }
    }

    /// Whether a point is in view: near enough, before the lens, on the image, and not behind the
    /// camera's own body.
    ///
    /// The way to the point is taken before it is turned, so that distances stay exact.
    #[inline]
    pub(crate) fn has(&self, p: &Point3<f64>) -> bool {
        let way = p - self.position;
        let in_camera = || Point3::from(self.camera_from_grid * way);
        way.norm() <= self.depth_max_m && self.camera.pixel_of(&in_camera()).is_some()
    }

    /// Whether the centre of a voxel between two corners can be in view; `true` in doubt.
    pub(crate) fn may_have(&self, spec: &GridSpec, low: VoxelIndex, high: VoxelIndex) -> bool {
        let (low, high) = (spec.centre(low) - self.position, spec.centre(high) - self.position);
        let (way, half) = ((low + high) / 2.0, (high - low) / 2.0);
        let margin = CLEARLY * (1.0 + way.norm() + half.norm());
        let nearest = (way.abs() - half).map(|gap| gap.max(0.0)).norm();
        let is_behind =
            |normal: &Vector3<f64>| normal.dot(&way) + normal.abs().dot(&half) < -margin;
        nearest <= self.depth_max_m + margin && !self.bounds.iter().any(is_behind)
    }
}

/// 1 where the centre of a voxel is in view of some camera, whatever stands before it.
///
/// It is Occ3D-Waymo's `infov`: cameras need not look everywhere.
pub fn in_view(eyes: &[Eye], spec: &GridSpec, depth_max_m: f64) -> VoxelGrid<u8> {
    let views: Vec<View> = eyes.iter().map(|eye| View::new(eye, depth_max_m)).collect();
    let is_seen = |voxel| views.iter().any(|view| view.has(&spec.centre(voxel)));
    VoxelGrid::from_values(spec, spec.voxels().map(|voxel| u8::from(is_seen(voxel))).collect())
}

/// Planes that bound a camera's field of view, camera frame, normals inwards.
fn bounds(camera: &Camera) -> Vec<Vector3<f64>> {
    match &camera.model {
        CameraModel::Pinhole(model) => sides(model.intrinsics(), camera.width, camera.height),
        CameraModel::BrownConrady(_) => vec![Vector3::z()],
        CameraModel::KannalaBrandt(_) | CameraModel::Mei(_) | CameraModel::Ocam(_) => vec![],
    }
}

/// The image plane, and the planes through the image's edges: left, right, upper, lower.
fn sides(intrinsics: &Intrinsics, width: u32, height: u32) -> Vec<Vector3<f64>> {
    let [u, v, w] = intrinsics.matrix().map(Vector3::from);
    let sides = [u, w * f64::from(width) - u, v, w * f64::from(height) - v];
    [w].into_iter().chain(sides.map(|side| side.normalize())).collect()
}
