//! Which flags a picture takes.

use occlabel_core::Fault;
use occlabel_view::{Across, Aim};

use crate::args::{AcrossArg, PictureArg, PictureArgs};

impl PictureArgs {
    /// The picture that is asked for.
    pub(crate) fn kind(&self) -> PictureArg {
        self.picture.unwrap_or(PictureArg::Sheet)
    }

    /// # Errors
    /// If a flag was set that the picture does not use, or one that it needs was not.
    pub(crate) fn check(&self, has_log: bool) -> Result<(), Fault> {
        let kind = self.kind();
        let takes = |flag: &str| taken(kind).contains(&flag);
        if let Some(flag) = self.set_flags().into_iter().find(|flag| !takes(flag)) {
            let expected = match taken(kind).join(", ") {
                none if none.is_empty() => "no flags but --size".to_owned(),
                some => format!("flags of this picture ({some})"),
            };
            return Err(fault(kind, expected, flag));
        }
        let is_of_orbit = |flag: &&str| ORBIT.contains(flag);
        match self.set_flags().into_iter().find(is_of_orbit) {
            Some(flag) if self.camera.is_some() => {
                let expected = "either a camera of the log or a place to look from";
                Err(fault(kind, expected, format!("--camera and {flag}")))
            }
            _ => self.check_needs(kind, has_log),
        }
    }

    /// Whether cameras of the log are drawn.
    pub(crate) fn needs_log(&self) -> bool {
        self.kind() == PictureArg::Overlay || self.camera.is_some()
    }

    fn check_needs(&self, kind: PictureArg, has_log: bool) -> Result<(), Fault> {
        if self.needs_log() && !has_log {
            let expected = "the log, which has the cameras: --format F --input LOG";
            return Err(fault(kind, expected, "none"));
        }
        if kind == PictureArg::Difference && self.against.is_none() {
            return Err(fault(kind, "the labels to compare with: --against DIR", "none"));
        }
        Ok(())
    }

    /// # Errors
    /// If any of these flags was set, though no picture is made.
    pub(crate) fn check_unused(&self) -> Result<(), Fault> {
        let first = self.picture.map(|_| "--picture").or(self.set_flags().first().copied());
        let first = first.or(self.size.map(|_| "--size"));
        let refuse = |flag| Err(Fault::new("flag", flag, "an output that ends in .png", "another"));
        first.map_or(Ok(()), refuse)
    }

    /// The flags that were set and that not every picture takes.
    fn set_flags(&self) -> Vec<&'static str> {
        let set = [
            ("--camera", self.camera.is_some()),
            ("--azimuth-deg", self.azimuth_deg.is_some()),
            ("--elevation-deg", self.elevation_deg.is_some()),
            ("--distance-m", self.distance_m.is_some()),
            ("--across", self.across.is_some()),
            ("--against", self.against.is_some()),
        ];
        set.into_iter().filter_map(|(flag, is_set)| is_set.then_some(flag)).collect()
    }

    /// From where a perspective picture is taken.
    pub(crate) fn aim(&self) -> Aim {
        let usual = match self.kind() {
            PictureArg::Perspective => Aim::default(),
            _ => Aim { elevation_rad: STEEP_DEG.to_radians(), ..Aim::default() },
        };
        Aim {
            azimuth_rad: self.azimuth_deg.map_or(usual.azimuth_rad, f64::to_radians),
            elevation_rad: self.elevation_deg.map_or(usual.elevation_rad, f64::to_radians),
            distance_m: self.distance_m,
        }
    }

    /// The axis that slices cut through.
    pub(crate) fn across(&self) -> Across {
        match self.across.unwrap_or(AcrossArg::Z) {
            AcrossArg::X => Across::X,
            AcrossArg::Y => Across::Y,
            AcrossArg::Z => Across::Z,
        }
    }
}

/// From so high is looked beside a map, where the picture is not wide.
const STEEP_DEG: f64 = 50.0;

const ORBIT: [&str; 3] = ["--azimuth-deg", "--elevation-deg", "--distance-m"];

fn taken(kind: PictureArg) -> &'static [&'static str] {
    match kind {
        PictureArg::Sheet => &ORBIT,
        PictureArg::Perspective => {
            &["--azimuth-deg", "--elevation-deg", "--distance-m", "--camera"]
        }
        PictureArg::Difference => {
            &["--azimuth-deg", "--elevation-deg", "--distance-m", "--against"]
        }
        PictureArg::Overlay => &["--camera"],
        PictureArg::Slices => &["--across"],
        PictureArg::BirdsEye | PictureArg::Strip => &[],
    }
}

fn fault(kind: PictureArg, expected: impl Into<String>, found: impl Into<String>) -> Fault {
    Fault::new("flag", format!("--picture {}", name(kind)), expected, found)
}

/// A picture's name on the command line.
pub(crate) fn name(kind: PictureArg) -> String {
    use clap::ValueEnum;
    kind.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}
