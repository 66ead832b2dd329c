//! A description as lines of text.

use std::fmt;

use crate::describe::{Contents, Description, SeenArray};

impl fmt::Display for Description {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.place)?;
        match self.dialects.as_slice() {
            [] => writeln!(f, "  looks like   no dialect")?,
            dialects => writeln!(f, "  looks like   {}", dialects.join(" or "))?,
        }
        self.arrays.iter().try_for_each(|array| writeln!(f, "  array        {array}"))?;
        if let Some(contents) = &self.contents {
            write!(f, "{contents}")?;
        }
        self.suspicions.iter().try_for_each(|odd| writeln!(f, "  suspicious   {odd}"))?;
        self.notes.iter().try_for_each(|note| writeln!(f, "  note         {note}"))?;
        if self.suspicions.is_empty() { write!(f, "  nothing suspicious") } else { Ok(()) }
    }
}

impl fmt::Display for SeenArray {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = if self.name.is_empty() { "" } else { &format!("{} ", self.name) };
        match &self.number {
            Some(number) => write!(f, "{name}{number} {:?}", self.shape),
            None => write!(f, "{name}is no array of plain numbers"),
        }
    }
}

impl fmt::Display for Contents {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let grid = &self.grid;
        let [x, y, z] = grid.shape;
        let (min, max, size) = (grid.min_m, grid.max_m, grid.voxel_size_m);
        writeln!(f, "  keyframes    {}", self.keyframes)?;
        writeln!(f, "  grid         {x} x {y} x {z}, {min:?} to {max:?} m, voxels {size:?} m")?;
        writeln!(f, "  frame        {}{}", grid.frame, ground(self.ground_m))?;
        let states = &self.states;
        self.state(f, "occupied", states.occupied)?;
        self.state(f, "free", states.free)?;
        match states.unobserved {
            Some(unobserved) => self.state(f, "unobserved", unobserved)?,
            None => writeln!(f, "  unobserved   not told")?,
        }
        if states.no_label > 0 {
            self.state(f, "no label", states.no_label)?;
        }
        writeln!(f, "  free id      {}", self.free)?;
        for class in &self.classes {
            let share = percent(class.voxels, states.occupied);
            writeln!(
                f,
                "  class {:6} {:22} {:>12} {share:>7} %",
                class.id, class.name, class.voxels
            )?;
        }
        Ok(())
    }
}

impl Contents {
    fn state(&self, f: &mut fmt::Formatter<'_>, name: &str, voxels: u64) -> fmt::Result {
        let share = percent(voxels, self.voxels);
        writeln!(f, "  {name:12} {voxels} ({share} %)")
    }
}

fn percent(part: u64, all: u64) -> String {
    format!("{:.2}", 100.0 * part as f64 / all.max(1) as f64)
}

fn ground(height_m: Option<f64>) -> String {
    height_m.map_or(String::new(), |z| format!("; ground near its origin at z {z:.2} m"))
}
