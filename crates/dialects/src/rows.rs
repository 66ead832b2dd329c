//! Rows of coordinates: one for each voxel that is not free.

use occlabel_core::{Fault, VoxelGrid, VoxelIndex};
use occlabel_labels::{NumberArray, read_npy};

use crate::class_table::UNKNOWN;
use crate::decode::{Found, fault};
use crate::values::{self, Refusal};
use crate::{ClassTable, Column, KeyframeLabels, Rows, Table};

/// A row is 7 numbers of 8 bytes at most.
const MAX_ROW_BYTES: u64 = 56;

impl Found<'_> {
    /// The labels of a table; where two rows name one voxel, the last.
    pub(crate) fn rows(&self, rows: &Rows) -> Result<KeyframeLabels, Fault> {
        let place = (self.places)("");
        let numbers = read_npy(&place, self.spec.len() as u64 * MAX_ROW_BYTES)?;
        let read = rows.table_of(&numbers).and_then(|table| self.rows_of(table, &numbers));
        read.map_err(|refusal| fault(&place, "", refusal))
    }

    fn rows_of(&self, table: &Table, numbers: &NumberArray) -> Result<KeyframeLabels, Refusal> {
        let mut labels = self.empty();
        let indices = self.classes.indices();
        let velocity = table.velocity().filter(|_| self.wanted.flow);
        labels.flow = velocity.map(|_| VoxelGrid::filled(self.spec, [0.0; 3]));
        let place = [Column::X, Column::Y, Column::Z, Column::Class].map(|it| table.place(it));
        for row in (0..numbers.len()).step_by(table.columns.len()) {
            let [x, y, z, id] = place.map(|column| whole(numbers.float(row + column)));
            let flat = self.voxel_of([x, y, z]).ok_or_else(|| outside(table, numbers, row))?;
            let index = id.and_then(|id| indices.get(usize::try_from(id).ok()?));
            match index.copied().unwrap_or(UNKNOWN) {
                UNKNOWN => return Err(unknown(table, numbers, row)),
                index => labels.semantics.values_mut()[flat] = index,
            }
            if let (Some(flow), Some(columns)) = (&mut labels.flow, velocity) {
                let part = |column| numbers.float(row + column) as f32;
                flow.values_mut()[flat] = columns.map(part);
            }
        }
        Ok(labels)
    }

    fn voxel_of(&self, [x, y, z]: [Option<i64>; 3]) -> Option<usize> {
        self.spec.flat(VoxelIndex([x?, y?, z?]))
    }
}

impl Rows {
    /// The table of so many columns.
    fn table_of(&self, numbers: &NumberArray) -> Result<&Table, Refusal> {
        let columns = numbers.shape.get(1).filter(|_| numbers.shape.len() == 2);
        let table = self.tables.iter().find(|table| Some(&table.columns.len()) == columns);
        table.ok_or_else(|| ("a table of the dialect's columns", format!("{:?}", numbers.shape)))
    }

    /// The table that labels are written as, with velocities or without.
    pub(crate) fn table_for(&self, labels: &KeyframeLabels) -> &Table {
        let fits = |table: &&Table| table.velocity().is_some() == labels.flow.is_some();
        self.tables.iter().find(fits).unwrap_or(&self.tables[0])
    }
}

impl Table {
    /// The rows of what is not free, in our order of voxels.
    pub(crate) fn encode(&self, labels: &KeyframeLabels, classes: &ClassTable) -> NumberArray {
        let ids = values::ids(classes, labels.semantics.values());
        let mut numbers = Vec::new();
        for (flat, voxel) in labels.spec.voxels().enumerate() {
            if classes.is_written(labels.semantics.values()[flat]) {
                let flow = labels.flow.as_ref().map_or([0.0; 3], |flow| flow.values()[flat]);
                let number = |column: &Column| column.number(&voxel, flow, ids[flat]);
                numbers.extend(self.columns.iter().map(number));
            }
        }
        let shape = [numbers.len() / self.columns.len(), self.columns.len()];
        NumberArray::of_floats(self.number, &shape, &numbers)
    }

    /// The columns of the velocities, if there are any.
    fn velocity(&self) -> Option<[usize; 3]> {
        let [x, y, z] = [Column::Vx, Column::Vy, Column::Vz].map(|column| self.column(column));
        Some([x?, y?, z?])
    }

    /// The place of a column that every table has.
    fn place(&self, column: Column) -> usize {
        self.column(column).expect("a column that every table has")
    }
}

impl Column {
    fn number(self, voxel: &VoxelIndex, flow: [f32; 3], id: i64) -> f64 {
        let [x, y, z] = voxel.0;
        match self {
            Self::X => x as f64,
            Self::Y => y as f64,
            Self::Z => z as f64,
            Self::Vx => f64::from(flow[0]),
            Self::Vy => f64::from(flow[1]),
            Self::Vz => f64::from(flow[2]),
            Self::Class => id as f64,
        }
    }
}

/// A number that has nothing after the point.
fn whole(number: f64) -> Option<i64> {
    let cut = number as i64;
    (cut as f64 == number).then_some(cut)
}

/// A row, by the place of its first number, that names no voxel.
fn outside(table: &Table, numbers: &NumberArray, row: usize) -> Refusal {
    let columns = table.columns.len();
    let told: Vec<f64> = (row..row + columns).map(|at| numbers.float(at)).collect();
    ("voxels of the grid", format!("row {}, {told:?}", row / columns))
}

fn unknown(table: &Table, numbers: &NumberArray, row: usize) -> Refusal {
    let place = table.place(Column::Class);
    let id = numbers.float(row + place);
    let rows = (0..numbers.len()).step_by(table.columns.len());
    let count = rows.filter(|row| numbers.float(row + place) == id).count();
    ("ids of the dialect's classes", format!("id {id} in {count} rows"))
}
