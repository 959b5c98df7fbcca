//! The messages of a file, one after another. Readers of messages in the crate `mcap` panic at a short attachment, and
//! reserve memory for the length that a text is said to have; here no length is believed before its bytes are there.

use crate::error::LogProblem;
use mcap::read::ChannelAccumulator;
use mcap::records::{Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{McapError, Message, parse_record};
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::Path;

/// Most bytes of a record, and of an unpacked chunk.
const MOST: usize = 256 << 20;
/// Bytes that are read at once.
const AT_ONCE: usize = 1 << 16;
/// Bytes before the text of a chunk's compression.
const CHUNK_HEAD: usize = 28;

pub(crate) struct Messages {
    source: File,
    reader: LinearReader,
    channels: ChannelAccumulator<'static>,
    chunk: Vec<u8>,
    /// Number of bytes of the chunk that are taken.
    taken: usize,
    /// Whether the end of the file is missing.
    pub(crate) is_cut: bool,
}

impl Messages {
    pub(crate) fn open(path: &Path) -> Result<Self, LogProblem> {
        let options = LinearReaderOptions::default().with_emit_chunks(true);
        Ok(Self {
            source: File::open(path)?,
            reader: LinearReader::new_with_options(options.with_record_length_limit(MOST)),
            channels: ChannelAccumulator::default(),
            chunk: Vec::new(),
            taken: 0,
            is_cut: false,
        })
    }

    /// The next message; `None` at the end.
    pub(crate) fn next(&mut self) -> Result<Option<Message<'static>>, LogProblem> {
        loop {
            let mut message = None;
            if let Some((head, rest)) = self.chunk[self.taken..].split_first_chunk::<9>() {
                let [opcode, length @ ..] = *head;
                let data = rest.get(..u64::from_le_bytes(length) as usize);
                let data = data.ok_or("a record goes beyond the end of its chunk")?;
                self.taken += head.len() + data.len();
                message = message_of(&mut self.channels, opcode, data)?;
            } else if self.taken < self.chunk.len() {
                return Err("a record goes beyond the end of its chunk".into());
            } else {
                match self.reader.next_event() {
                    None | Some(Ok(LinearReadEvent::Record { opcode: op::DATA_END, .. })) => return Ok(None),
                    Some(Ok(LinearReadEvent::ReadRequest(wanted))) => {
                        match self.source.read(self.reader.insert(wanted.min(AT_ONCE))) {
                            Err(error) if error.kind() == ErrorKind::Interrupted => {}
                            read => self.reader.notify_read(read?),
                        }
                    }
                    Some(Ok(LinearReadEvent::Record { opcode: op::CHUNK, data })) => {
                        (self.chunk, self.taken) = (unpacked(data)?, 0);
                    }
                    Some(Ok(LinearReadEvent::Record { opcode, data })) => {
                        message = message_of(&mut self.channels, opcode, data)?;
                    }
                    Some(Err(McapError::UnexpectedEof)) => {
                        self.is_cut = true;
                        return Ok(None);
                    }
                    Some(Err(McapError::BadMagic)) => return Err("the file is not MCAP".into()),
                    Some(Err(error)) => return Err(error.into()),
                }
            }
            if message.is_some() {
                return Ok(message);
            }
        }
    }
}

/// Takes a record: a message or, for later, a channel or schema.
fn message_of(
    channels: &mut ChannelAccumulator<'static>,
    opcode: u8,
    data: &[u8],
) -> Result<Option<Message<'static>>, LogProblem> {
    let fits = match opcode {
        op::SCHEMA => counted(data, 2, 3).is_some(),
        op::CHANNEL => counted(data, 4, 3).is_some_and(|parts| counted(parts[2], 0, usize::MAX).is_some()),
        op::MESSAGE => true,
        _ => return Ok(None),
    };
    if !fits {
        return Err("a record is shorter than it says".into());
    }
    match parse_record(opcode, data)? {
        Record::Schema { header, data } => channels.add_schema_from_slice(header, &data)?,
        Record::Channel(channel) => channels.add_channel(channel)?,
        Record::Message { header, data } => {
            let channel = channels.get(header.channel_id).ok_or("a message of no known channel")?;
            return Ok(Some(Message {
                channel,
                sequence: header.sequence,
                log_time: header.log_time,
                publish_time: header.publish_time,
                data: data.into_owned().into(),
            }));
        }
        _ => {}
    }
    Ok(None)
}

/// Up to `most` parts from byte `start` on, each behind its length; `None` if one is shorter than its length.
fn counted(data: &[u8], start: usize, most: usize) -> Option<Vec<&[u8]>> {
    let (mut rest, mut parts) = (data.get(start..)?, Vec::new());
    while parts.len() < most && !(rest.is_empty() && most == usize::MAX) {
        let (length, tail) = rest.split_first_chunk()?;
        let part;
        (part, rest) = tail.split_at_checked(u32::from_le_bytes(*length) as usize)?;
        parts.push(part);
    }
    Some(parts)
}

/// The records of a chunk.
fn unpacked(chunk: &[u8]) -> Result<Vec<u8>, LogProblem> {
    let parsed = counted(chunk, CHUNK_HEAD, 1).and_then(|_| parse_record(op::CHUNK, chunk).ok());
    let Some(Record::Chunk { header, data }) = parsed else { return Err("a chunk is shorter than it says".into()) };
    let packed: Box<dyn Read> = match header.compression.as_str() {
        "" => Box::new(&*data),
        "zstd" => Box::new(ruzstd::decoding::StreamingDecoder::new(&*data).map_err(LogProblem::of_chunk)?),
        "lz4" => Box::new(lz4_flex::frame::FrameDecoder::new(&*data)),
        other => return Err(format!("chunks are compressed by {other:?}; zstd and lz4 are read").into()),
    };
    let mut records = Vec::new();
    packed.take(MOST as u64).read_to_end(&mut records).map_err(LogProblem::of_chunk)?;
    let crc = header.uncompressed_crc;
    if records.len() as u64 != header.uncompressed_size || (crc != 0 && crc32fast::hash(&records) != crc) {
        return Err(LogProblem::Chunk(format!("its checksum or size is wrong, or it is larger than {MOST} bytes")));
    }
    Ok(records)
}
