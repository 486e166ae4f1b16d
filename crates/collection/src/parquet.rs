//! Tables as Parquet files: flat columns, and lists of equally many numbers.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use mser3d_fileio::{InputFile, write_atomically};
use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int32Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{Type, TypePtr};

use crate::CollectionError;

/// A column of a table.
pub(crate) enum Column {
    Text(Vec<String>),
    OptionalText(Vec<Option<String>>),
    Integer(Vec<i32>),
    OptionalInteger(Vec<Option<i32>>),
    Number(Vec<f64>),
    OptionalNumber(Vec<Option<f64>>),
    /// `width` numbers in each row.
    Numbers {
        width: usize,
        values: Vec<f64>,
    },
}

/// Writes a table, uncompressed, in one piece. The same columns make the same bytes.
pub(crate) fn write(
    path: &Path,
    columns: &[(&str, Column)],
    notes: &[(&str, String)],
) -> Result<(), CollectionError> {
    let fields = columns.iter().map(|(name, column)| column.field(name)).collect::<Result<Vec<_>, _>>();
    let fields = fields.map_err(table_error(path))?;
    let schema = Type::group_type_builder("schema").with_fields(fields).build().map_err(table_error(path))?;
    let notes = notes.iter().map(|(key, value)| KeyValue::new((*key).to_owned(), value.clone()));
    let properties = WriterProperties::builder()
        .set_created_by(concat!("mser3d-collection ", env!("CARGO_PKG_VERSION")).to_owned())
        .set_key_value_metadata(Some(notes.collect()))
        .build();
    write_atomically(path, |out| {
        let mut file = SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties))?;
        let mut rows = file.next_row_group()?;
        columns.iter().try_for_each(|(_, column)| column.write(&mut rows))?;
        rows.close()?;
        file.close()?;
        Ok(())
    })?;
    Ok(())
}

fn table_error(path: &Path) -> impl Fn(ParquetError) -> CollectionError {
    let path = path.to_owned();
    move |e| CollectionError::Table { path: path.clone(), reason: e.to_string() }
}

impl Column {
    fn field(&self, name: &str) -> Result<TypePtr, ParquetError> {
        let primitive = |physical, repetition| {
            let builder = Type::primitive_type_builder(name, physical).with_repetition(repetition);
            let text = physical == Physical::BYTE_ARRAY;
            builder.with_logical_type(text.then_some(LogicalType::String)).build()
        };
        let field = match self {
            Self::Text(_) => primitive(Physical::BYTE_ARRAY, Repetition::REQUIRED)?,
            Self::OptionalText(_) => primitive(Physical::BYTE_ARRAY, Repetition::OPTIONAL)?,
            Self::Integer(_) => primitive(Physical::INT32, Repetition::REQUIRED)?,
            Self::OptionalInteger(_) => primitive(Physical::INT32, Repetition::OPTIONAL)?,
            Self::Number(_) => primitive(Physical::DOUBLE, Repetition::REQUIRED)?,
            Self::OptionalNumber(_) => primitive(Physical::DOUBLE, Repetition::OPTIONAL)?,
            Self::Numbers { .. } => {
                let required = Repetition::REQUIRED;
                let element = Type::primitive_type_builder("element", Physical::DOUBLE);
                let element = Arc::new(element.with_repetition(required).build()?);
                let list = Type::group_type_builder("list").with_repetition(Repetition::REPEATED);
                let list = Arc::new(list.with_fields(vec![element]).build()?);
                Type::group_type_builder(name)
                    .with_repetition(required)
                    .with_logical_type(Some(LogicalType::List))
                    .with_fields(vec![list])
                    .build()?
            }
        };
        Ok(Arc::new(field))
    }

    fn write<W: std::io::Write + Send>(
        &self,
        rows: &mut SerializedRowGroupWriter<'_, W>,
    ) -> Result<(), ParquetError> {
        let bytes = |text: &String| ByteArray::from(text.as_str());
        match self {
            Self::Text(v) => {
                put::<ByteArrayType, _>(rows, &v.iter().map(bytes).collect::<Vec<_>>(), None, None)
            }
            Self::OptionalText(v) => {
                let values: Vec<ByteArray> = v.iter().flatten().map(bytes).collect();
                put::<ByteArrayType, _>(rows, &values, Some(&presence(v)), None)
            }
            Self::Integer(v) => put::<Int32Type, _>(rows, v, None, None),
            Self::OptionalInteger(v) => put::<Int32Type, _>(rows, &present(v), Some(&presence(v)), None),
            Self::Number(v) => put::<DoubleType, _>(rows, v, None, None),
            Self::OptionalNumber(v) => put::<DoubleType, _>(rows, &present(v), Some(&presence(v)), None),
            Self::Numbers { width, values } => {
                // Every list has elements; the first of each begins a row.
                let begins: Vec<i16> =
                    (0..values.len()).map(|i| i16::from(!i.is_multiple_of(*width))).collect();
                put::<DoubleType, _>(rows, values, Some(&vec![1; values.len()]), Some(&begins))
            }
        }
    }
}

fn presence<T>(values: &[Option<T>]) -> Vec<i16> {
    values.iter().map(|v| v.is_some().into()).collect()
}

fn present<T: Copy>(values: &[Option<T>]) -> Vec<T> {
    values.iter().flatten().copied().collect()
}

fn put<T: DataType, W: std::io::Write + Send>(
    rows: &mut SerializedRowGroupWriter<'_, W>,
    values: &[T::T],
    definition: Option<&[i16]>,
    repetition: Option<&[i16]>,
) -> Result<(), ParquetError> {
    let Some(mut column) = rows.next_column()? else {
        return Err(ParquetError::General("more columns than the schema has".into()));
    };
    column.typed::<T>().write_batch(values, definition, repetition)?;
    column.close()
}

/// A table that was written by [`write`].
pub(crate) struct Table {
    path: std::path::PathBuf,
    file: SerializedFileReader<File>,
}

impl Table {
    pub fn open(path: &Path) -> Result<Self, CollectionError> {
        let file = match InputFile::open(path).map_err(CollectionError::io(path))? {
            InputFile::Regular(file) => file,
            InputFile::Stdin(_) => unreachable!("no table has this name"),
        };
        let file = SerializedFileReader::new(file).map_err(table_error(path))?;
        Ok(Self { path: path.to_owned(), file })
    }

    /// What was noted with the table.
    pub fn note(&self, key: &str) -> Option<&str> {
        let notes = self.file.metadata().file_metadata().key_value_metadata()?;
        notes.iter().find(|note| note.key == key)?.value.as_deref()
    }

    pub fn rows(&self) -> usize {
        self.file.metadata().file_metadata().num_rows().max(0) as usize
    }

    pub fn texts(&self, name: &str) -> Result<Vec<String>, CollectionError> {
        let bytes = self.column::<ByteArrayType>(name)?;
        let text = |b: &ByteArray| b.as_utf8().map(str::to_owned).map_err(table_error(&self.path));
        bytes.iter().map(text).collect()
    }

    pub fn integers(&self, name: &str) -> Result<Vec<i32>, CollectionError> {
        self.column::<Int32Type>(name)
    }

    /// Numbers, or the elements of all lists.
    pub fn numbers(&self, name: &str) -> Result<Vec<f64>, CollectionError> {
        self.column::<DoubleType>(name)
    }

    /// A column that may lack values.
    pub fn optional_integers(&self, name: &str) -> Result<Vec<Option<i32>>, CollectionError> {
        self.optional::<Int32Type>(name)
    }

    /// A column that may lack values.
    pub fn optional_numbers(&self, name: &str) -> Result<Vec<Option<f64>>, CollectionError> {
        self.optional::<DoubleType>(name)
    }

    fn optional<T: DataType>(&self, name: &str) -> Result<Vec<Option<T::T>>, CollectionError> {
        let (values, present) = self.column_with_presence::<T>(name)?;
        let mut values = values.into_iter();
        Ok(present.into_iter().map(|level| if level > 0 { values.next() } else { None }).collect())
    }

    /// All values that are present.
    fn column<T: DataType>(&self, name: &str) -> Result<Vec<T::T>, CollectionError> {
        Ok(self.column_with_presence::<T>(name)?.0)
    }

    /// All values that are present; and for each row of a column that may lack some, 1 where it has one, else 0.
    fn column_with_presence<T: DataType>(
        &self,
        name: &str,
    ) -> Result<(Vec<T::T>, Vec<i16>), CollectionError> {
        let fail = table_error(&self.path);
        let schema = self.file.metadata().file_metadata().schema_descr();
        let found = schema.columns().iter().position(|c| c.path().parts().first().is_some_and(|p| p == name));
        let good = found.filter(|&at| schema.column(at).physical_type() == T::get_physical_type());
        let Some(at) = good else {
            return Err(fail(ParquetError::General(format!(
                "there is no column {name} of the right type; run `mser3d batch` again"
            ))));
        };
        let (mut values, mut definition, mut repetition) = (Vec::new(), Vec::new(), Vec::new());
        for group in 0..self.file.num_row_groups() {
            let rows = self.file.get_row_group(group).map_err(&fail)?;
            let reader = rows.get_column_reader(at).map_err(&fail)?;
            let mut reader = parquet::column::reader::get_typed_column_reader::<T>(reader);
            loop {
                let (records, _, _) = reader
                    .read_records(1 << 16, Some(&mut definition), Some(&mut repetition), &mut values)
                    .map_err(&fail)?;
                if records == 0 {
                    break;
                }
            }
        }
        Ok((values, definition))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_come_back_and_bytes_repeat() {
        let folder = tempfile::tempdir().unwrap();
        let columns = [
            ("name", Column::Text(vec!["a".into(), "\u{e9}".into(), String::new()])),
            ("maybe", Column::OptionalText(vec![None, Some("x".into()), None])),
            ("id", Column::Integer(vec![3, -1, 0])),
            ("parent", Column::OptionalInteger(vec![Some(7), None, Some(8)])),
            ("volume", Column::Number(vec![0.1, f64::INFINITY, -0.0])),
            ("time", Column::OptionalNumber(vec![None, None, Some(2.5)])),
            ("descriptor", Column::Numbers { width: 2, values: vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0] }),
        ];
        let paths = ["a.parquet", "b.parquet"].map(|name| folder.path().join(name));
        for path in &paths {
            write(path, &columns, &[("settings", "{}".to_owned())]).unwrap();
        }
        assert_eq!(std::fs::read(&paths[0]).unwrap(), std::fs::read(&paths[1]).unwrap());
        let table = Table::open(&paths[0]).unwrap();
        assert_eq!((table.rows(), table.note("settings"), table.note("none")), (3, Some("{}"), None));
        assert_eq!(table.texts("name").unwrap(), ["a", "\u{e9}", ""]);
        assert_eq!(table.texts("maybe").unwrap(), ["x"]);
        assert_eq!(table.integers("id").unwrap(), [3, -1, 0]);
        assert_eq!(table.integers("parent").unwrap(), [7, 8]);
        assert_eq!(table.optional_integers("parent").unwrap(), [Some(7), None, Some(8)]);
        assert_eq!(table.optional_numbers("time").unwrap(), [None, None, Some(2.5)]);
        assert_eq!(table.numbers("volume").unwrap(), [0.1, f64::INFINITY, -0.0]);
        assert_eq!(table.numbers("time").unwrap(), [2.5]);
        assert_eq!(table.numbers("descriptor").unwrap(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert!(table.numbers("id").unwrap_err().to_string().contains("no column id"));
    }

    #[test]
    fn a_table_without_rows_and_damaged_tables() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.parquet");
        let columns = [
            ("name", Column::Text(Vec::new())),
            ("descriptor", Column::Numbers { width: 6, values: Vec::new() }),
        ];
        write(&path, &columns, &[]).unwrap();
        assert_eq!(Table::open(&path).unwrap().numbers("descriptor").unwrap(), [0.0; 0]);
        let bytes = std::fs::read(&path).unwrap();
        for end in [0, 3, bytes.len() / 2, bytes.len() - 1] {
            std::fs::write(&path, &bytes[..end]).unwrap();
            assert!(Table::open(&path).err().unwrap().to_string().contains("t.parquet"));
        }
    }
}
