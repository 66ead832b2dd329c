//! Points with what is known of each.

use nalgebra::Point3;

use crate::ClassId;

/// A point's label as logged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointLabel {
    /// Nobody labelled it. It never counts as class 0.
    Unlabelled,
    /// Its raw label means `ignore`: noise, the ego vehicle.
    Ignored,
    /// Its raw label means this class.
    Class(ClassId),
}

/// Points of one frame, with a label of type `L` and a ray origin each.
///
/// `L` tells how far the points have come: [`PointLabel`] as logged, `Option<ClassId>` once split
/// into background and objects, [`ClassId`] once relabelled. Coordinates are metres.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointCloud<L> {
    /// Where each point is.
    pub positions: Vec<Point3<f64>>,
    /// What each point is.
    pub labels: Vec<L>,
    /// Each point's ray origin, as an index into `origins`.
    pub origin_of: Vec<u32>,
    /// Ray origins, in the frame of the points: one per sweep, or as many as the reader knows.
    pub origins: Vec<Point3<f64>>,
}

/// Whether a point stands anywhere.
#[inline]
pub fn is_finite(position: &Point3<f64>) -> bool {
    position.x.is_finite() & position.y.is_finite() & position.z.is_finite()
}

impl<L> PointCloud<L> {
    /// An empty cloud whose points will have come from `origins`.
    pub fn with_origins(origins: Vec<Point3<f64>>) -> Self {
        Self { positions: Vec::new(), labels: Vec::new(), origin_of: Vec::new(), origins }
    }

    /// Points that share one ray origin.
    ///
    /// # Panics
    /// If there is not one label per point.
    pub fn from_one_origin(
        origin: Point3<f64>,
        positions: Vec<Point3<f64>>,
        labels: Vec<L>,
    ) -> Self {
        assert_eq!(positions.len(), labels.len(), "one label per point");
        let origin_of = vec![0; positions.len()];
        Self { positions, labels, origin_of, origins: vec![origin] }
    }

    /// Makes room for so many more points.
    pub fn reserve(&mut self, points: usize) {
        self.positions.reserve_exact(points);
        self.labels.reserve_exact(points);
        self.origin_of.reserve_exact(points);
    }

    /// How many points there are.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Adds a point.
    #[inline]
    pub fn push(&mut self, position: Point3<f64>, label: L, origin: u32) {
        self.positions.push(position);
        self.labels.push(label);
        self.origin_of.push(origin);
    }

    /// The ray origin of point `i`.
    #[inline]
    pub fn origin(&self, i: usize) -> Point3<f64> {
        self.origins[self.origin_of[i] as usize]
    }
}

impl<L: Copy> PointCloud<L> {
    /// The points for which `relabel` has a label, with that label, in order.
    pub fn filter_map<M>(
        mut self,
        mut relabel: impl FnMut(usize, L) -> Option<M>,
    ) -> PointCloud<M> {
        let mut labels = Vec::with_capacity(self.len());
        for i in 0..self.positions.len() {
            if let Some(label) = relabel(i, self.labels[i]) {
                self.positions[labels.len()] = self.positions[i];
                self.origin_of[labels.len()] = self.origin_of[i];
                labels.push(label);
            }
        }
        self.positions.truncate(labels.len());
        self.origin_of.truncate(labels.len());
        PointCloud {
            positions: self.positions,
            labels,
            origin_of: self.origin_of,
            origins: self.origins,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filter_map_keeps_each_point_with_its_own_origin() {
        let mut cloud =
            PointCloud::with_origins(vec![Point3::origin(), Point3::new(9.0, 0.0, 0.0)]);
        for i in 0..6 {
            cloud.push(Point3::new(f64::from(i), 0.0, 0.0), i, i as u32 % 2);
        }
        let odd = cloud.filter_map(|_, label| (label % 2 == 1).then_some(label * 10));
        assert_eq!(odd.labels, [10, 30, 50]);
        assert_eq!(odd.positions[2].x, 5.0);
        assert!((0..3).all(|i| odd.origin(i).x == 9.0));
    }
}
