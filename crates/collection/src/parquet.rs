//! Tables as Parquet files: flat columns, and lists of equally many numbers. They are read by [`crate::parquet_table`].

use std::path::Path;
use std::sync::Arc;

use mser3d_fileio::write_atomically;
use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int32Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parquet_table::Table;

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
        assert_eq!(table.column::<String>("name").unwrap(), ["a", "\u{e9}", ""]);
        assert_eq!(table.optional::<String>("maybe").unwrap(), [None, Some("x".into()), None]);
        assert_eq!(table.column::<i32>("id").unwrap(), [3, -1, 0]);
        assert_eq!(table.optional::<i32>("parent").unwrap(), [Some(7), None, Some(8)]);
        assert_eq!(table.optional::<f64>("time").unwrap(), [None, None, Some(2.5)]);
        assert_eq!(table.column::<f64>("volume").unwrap(), [0.1, f64::INFINITY, -0.0]);
        let lists = table.lists("descriptor").unwrap();
        assert_eq!(lists, (2, vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
        let error = |result: Result<Vec<f64>, CollectionError>| result.unwrap_err().to_string();
        assert!(error(table.column("id")).contains("no column id"));
        // A column that lacks values is not taken for one that does not.
        assert!(error(table.column("time")).contains("column time cannot be read"));
    }

    /// Several pages, a dictionary that is given up when it grows too large, and runs of every length.
    #[test]
    fn large_tables_come_back_as_the_library_reads_them() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.parquet");
        let rows = 60_000;
        let names: Vec<String> = (0..rows).map(|i| format!("shape{}", i / 37)).collect();
        let ids: Vec<i32> = (0..rows).map(|i| i % 37).collect();
        let twins: Vec<Option<i32>> = (0..rows).map(|i| (i % 5 > 1 || i > 40_000).then_some(i)).collect();
        let fine: Vec<f64> = (0..rows).map(|i| f64::from(i).sqrt()).collect();
        let values: Vec<f64> = (0..3 * rows).map(|i| f64::from(i % 70_001)).collect();
        let columns = [
            ("name", Column::Text(names.clone())),
            ("id", Column::Integer(ids.clone())),
            ("twin", Column::OptionalInteger(twins.clone())),
            ("none", Column::OptionalNumber(vec![None; rows as usize])),
            ("fine", Column::Number(fine.clone())),
            ("same", Column::Number(vec![0.5; rows as usize])),
            ("list", Column::Numbers { width: 3, values: values.clone() }),
        ];
        write(&path, &columns, &[]).unwrap();
        let table = Table::open(&path).unwrap();
        assert_eq!(table.rows(), rows as usize);
        assert!(table.column::<String>("name").unwrap() == names);
        assert!(table.column::<i32>("id").unwrap() == ids);
        assert!(table.optional::<i32>("twin").unwrap() == twins);
        assert!(table.optional::<f64>("none").unwrap().iter().all(Option::is_none));
        assert!(table.column::<f64>("fine").unwrap() == fine);
        assert!(table.column::<f64>("same").unwrap() == vec![0.5; rows as usize]);
        assert!(table.lists("list").unwrap() == (3, values));
    }

    /// Every byte of a small table changed, and every length it could be cut to: an error, or other values, never a panic, and never
    /// more memory than the file stands for.
    #[test]
    fn damaged_tables_are_errors() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.parquet");
        let columns = [
            ("name", Column::Text(vec!["a".into(), "b".into(), "a".into()])),
            ("id", Column::Integer(vec![1, 2, 3])),
            ("twin", Column::OptionalInteger(vec![Some(1), None, Some(2)])),
            ("list", Column::Numbers { width: 2, values: vec![0.5; 6] }),
        ];
        write(&path, &columns, &[("settings", "{}".into())]).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let read = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            let table = Table::open(&path)?;
            table.column::<String>("name")?;
            table.column::<i32>("id")?;
            table.optional::<i32>("twin")?;
            table.lists("list").map(|_| ())
        };
        read(&bytes).unwrap();
        for end in 0..bytes.len() {
            let error = read(&bytes[..end]).unwrap_err().to_string();
            assert!(error.contains("t.parquet") && error.contains("batch --merge"), "{error}");
        }
        let mut refused = 0;
        for at in 0..bytes.len() {
            for flip in [1, 2, 4, 0x10, 0x40, 0x80, 0xff] {
                let mut damaged = bytes.clone();
                damaged[at] ^= flip;
                if let Err(error) = read(&damaged) {
                    assert!(error.to_string().contains("t.parquet"), "{error}");
                    refused += 1;
                }
            }
        }
        assert!(refused > bytes.len(), "{refused}");
    }

    #[test]
    fn a_table_without_rows() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.parquet");
        let columns = [
            ("name", Column::Text(Vec::new())),
            ("descriptor", Column::Numbers { width: 6, values: Vec::new() }),
        ];
        write(&path, &columns, &[]).unwrap();
        let table = Table::open(&path).unwrap();
        assert_eq!((table.rows(), table.lists("descriptor").unwrap()), (0, (0, Vec::new())));
        assert!(table.column::<String>("name").unwrap().is_empty());
    }
}
