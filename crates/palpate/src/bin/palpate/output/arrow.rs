//! Schema by which programs that read Parquet through Arrow know the metadata of columns.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use palpate::{ColumnType, ValueKind};
use polars_arrow_format::ipc::planus::Builder;
use polars_arrow_format::ipc::{
    Field, FloatingPoint, Int, KeyValue, Message, MessageHeader, MetadataVersion, Precision,
    Schema, Type, Utf8,
};

/// Key of the unit of a column.
const UNIT: &str = "unit";

/// Entry of a file's metadata with the schema of its columns: the message of Arrow's stream format, as base64. It repeats
/// the other entries, which readers take from it alone.
pub(super) fn schema(columns: &[ColumnType], entries: &[(&str, String)]) -> (&'static str, String) {
    let entries = entries.iter().map(|(key, value)| key_value(key, value));
    let schema = Schema {
        fields: Some(columns.iter().map(field).collect()),
        custom_metadata: Some(entries.collect()),
        ..Schema::default()
    };
    let message = Message {
        version: MetadataVersion::V5,
        header: Some(MessageHeader::Schema(Box::new(schema))),
        ..Message::default()
    };
    let mut builder = Builder::new();
    let message = builder.finish(&message, None);
    let padding = message.len().next_multiple_of(8) - message.len();
    let length = (message.len() + padding) as u32;
    let mut bytes = vec![0xff; 4];
    bytes.extend_from_slice(&length.to_le_bytes());
    bytes.extend_from_slice(message);
    bytes.extend(std::iter::repeat_n(0, padding));
    ("ARROW:schema", STANDARD.encode(bytes))
}

fn field(column: &ColumnType) -> Field {
    let whole = |is_signed| {
        let bit_width = 64;
        Type::Int(Box::new(Int {
            bit_width,
            is_signed,
        }))
    };
    let unit = column.unit.as_ref();
    let unit = unit.map(|unit| vec![key_value(UNIT, unit)]);
    Field {
        name: Some(column.name.clone()),
        nullable: true,
        type_: Some(match column.kind {
            ValueKind::Number => Type::FloatingPoint(Box::new(FloatingPoint {
                precision: Precision::Double,
            })),
            ValueKind::Whole => whole(true),
            ValueKind::Count => whole(false),
            ValueKind::Text => Type::Utf8(Box::new(Utf8 {})),
        }),
        // Readers take a field without children for one that is broken.
        children: Some(Vec::new()),
        custom_metadata: unit,
        ..Field::default()
    }
}

fn key_value(key: &str, value: &str) -> KeyValue {
    KeyValue {
        key: Some(key.to_owned()),
        value: Some(value.to_owned()),
    }
}
