//! The file: safetensors, with the record as JSON in its metadata under the key `adit-nlos`.

use super::{Model, Record, VERSION};
use crate::baseline::Baseline;
use crate::discriminant::Discriminant;
use crate::error::NlosError;
use crate::features;
use crate::network::{Layer, Network, ResponseBranch, WIDTH};
use crate::normal_scores::{LEVELS, NormalScores};
use crate::task::Task;
use crate::window::CHANNELS;
use safetensors::{Dtype, SafeTensors, tensor::TensorView};
use std::collections::HashMap;

const KEY: &str = "adit-nlos";

/// A tensor to write: name, shape, values.
type Named = (String, Vec<usize>, Vec<u8>);

impl Model {
    /// The bytes of its file.
    pub fn to_bytes(&self) -> Result<Vec<u8>, NlosError> {
        let fail = |what: String| NlosError::Model { name: "model".to_owned(), what };
        let record = serde_json::to_string(&self.record).map_err(|e| fail(e.to_string()))?;
        let tensors = self.tensors();
        let views = tensors
            .iter()
            .map(|(name, shape, bytes)| {
                let view = TensorView::new(Dtype::F32, shape.clone(), bytes);
                view.map(|view| (name.as_str(), view)).map_err(|e| fail(e.to_string()))
            })
            .collect::<Result<Vec<_>, _>>()?;
        let metadata = HashMap::from([(KEY.to_owned(), record)]);
        safetensors::serialize(views, Some(metadata)).map_err(|e| fail(e.to_string()))
    }

    /// From the bytes of its file; `name` is that of the file, for errors.
    pub fn from_bytes(name: &str, bytes: &[u8]) -> Result<Self, NlosError> {
        Reader::new(name, bytes)?.model()
    }

    fn tensors(&self) -> Vec<Named> {
        let Baseline { normal, discriminants, used, .. } = &self.baseline;
        let weights: Vec<f32> = discriminants.iter().flat_map(|d| d.weights.iter().copied()).collect();
        let biases: Vec<f32> = discriminants.iter().map(|d| d.bias).collect();
        let levels: Vec<f32> = normal.iter().flat_map(|n| n.values).collect();
        let mut tensors = vec![
            named("normal", &[used.len(), LEVELS], &levels),
            named("discriminant.weight", &[discriminants.len(), used.len()], &weights),
            named("discriminant.bias", &[discriminants.len()], &biases),
        ];
        if let Some(network) = &self.network {
            let mut layers = vec![("head", &network.head)];
            layers.extend(network.dense.as_ref().map(|dense| ("dense", dense)));
            if let Some(response) = &network.response {
                layers.extend([
                    ("first", &response.first),
                    ("second", &response.second),
                    ("input", &response.input),
                ]);
                let state = response.state();
                tensors.push(named("network.recurrent.weight", &[state, 4 * state], &response.recurrent));
            }
            for (name, layer) in layers {
                let (inputs, outputs) = (layer.inputs(), layer.outputs());
                tensors.push(named(&format!("network.{name}.weight"), &[inputs, outputs], &layer.weight));
                tensors.push(named(&format!("network.{name}.bias"), &[outputs], &layer.bias));
            }
        }
        tensors
    }
}

fn named(name: &str, shape: &[usize], values: &[f32]) -> Named {
    (name.to_owned(), shape.to_vec(), values.iter().flat_map(|v| v.to_le_bytes()).collect())
}

/// A file being read.
struct Reader<'a> {
    name: &'a str,
    tensors: SafeTensors<'a>,
    record: Record,
    task: Task,
}

impl<'a> Reader<'a> {
    fn new(name: &'a str, bytes: &'a [u8]) -> Result<Self, NlosError> {
        let fail = |what: String| NlosError::Model { name: name.to_owned(), what };
        let not_ours = |e: safetensors::SafeTensorError| fail(format!("this is no safetensors file: {e}"));
        let tensors = SafeTensors::deserialize(bytes).map_err(not_ours)?;
        let (_, metadata) = SafeTensors::read_metadata(bytes).map_err(not_ours)?;
        let record = metadata.metadata().as_ref().and_then(|m| m.get(KEY));
        let record = record.ok_or_else(|| {
            fail(format!("no record under the key {KEY} in its metadata: no model of adit nlos train"))
        })?;
        let record: Record =
            serde_json::from_str(record).map_err(|e| fail(format!("its record cannot be read: {e}")))?;
        if record.version != VERSION {
            return Err(fail(format!("found layout {}, expected {VERSION}", record.version)));
        }
        let Some(task) = Task::by_classes(&record.classes) else {
            return Err(fail(format!("found the classes {:?}, which no task has", record.classes)));
        };
        let network = record.network.iter().flat_map(|network| &network.scalings);
        let mut scalings = record.baseline_scalings.iter().chain(network);
        if let Some(odd) = scalings.find(|s| !(s.scale.is_finite() && s.offset.is_finite())) {
            return Err(fail(format!("found a scaling {odd:?}, expected finite numbers")));
        }
        Ok(Self { name, tensors, record, task })
    }

    fn fail(&self, what: String) -> NlosError {
        NlosError::Model { name: self.name.to_owned(), what }
    }

    fn model(self) -> Result<Model, NlosError> {
        let questions = self.task.questions();
        let used = self
            .record
            .features
            .iter()
            .map(|name| {
                let known = features::NAMES.iter().position(|known| known == name);
                known.ok_or_else(|| self.fail(format!("unknown feature \"{name}\"")))
            })
            .collect::<Result<Vec<_>, _>>()?;
        if used.is_empty() {
            return Err(self.fail("found no features, expected some".to_owned()));
        }
        let levels = self.values("normal", &[used.len(), LEVELS])?;
        let (levels, _) = levels.as_chunks::<LEVELS>();
        let normal = levels.iter().map(|values| NormalScores { values: *values }).collect();
        let weights = self.values("discriminant.weight", &[questions, used.len()])?;
        let biases = self.values("discriminant.bias", &[questions])?;
        let of = |(weights, bias): (&[f32], f32)| Discriminant { weights: weights.to_vec(), bias };
        let discriminants = weights.chunks(used.len()).zip(biases).map(of).collect();
        let network =
            self.record.network.as_ref().map(|_| self.network(used.len(), questions)).transpose()?;
        let task = self.task;
        Ok(Model { task, baseline: Baseline::new(used, normal, discriminants), network, record: self.record })
    }

    fn network(&self, features: usize, questions: usize) -> Result<Network, NlosError> {
        let response = if self.tensors.names().contains(&"network.first.weight") {
            let first = self.layer("first", WIDTH * CHANNELS)?;
            let second = self.layer("second", WIDTH * first.outputs())?;
            let input = self.layer("input", second.outputs())?;
            let state = input.outputs() / 4;
            if state == 0 || input.outputs() % 4 != 0 {
                return Err(
                    self.fail(format!("network.input has {} outputs, expected four gates", input.outputs()))
                );
            }
            let recurrent = self.values("network.recurrent.weight", &[state, 4 * state])?;
            Some(ResponseBranch { first, second, input, recurrent })
        } else {
            None
        };
        let state = response.as_ref().map_or(0, ResponseBranch::state);
        let has_dense = self.tensors.names().contains(&"network.dense.weight");
        let dense = if has_dense { Some(self.layer("dense", features)?) } else { None };
        let head = self.layer("head", state + dense.as_ref().map_or(0, Layer::outputs) + features)?;
        if head.outputs() != questions {
            return Err(
                self.fail(format!("network.head has {} outputs, expected {questions}", head.outputs()))
            );
        }
        Ok(Network { response, dense, head })
    }

    /// A layer of so many inputs and any number of outputs, up to 4096.
    fn layer(&self, name: &str, inputs: usize) -> Result<Layer, NlosError> {
        let (weight, bias) = (format!("network.{name}.weight"), format!("network.{name}.bias"));
        let outputs = self.tensors.tensor(&bias).map_or(0, |t| t.shape().iter().product());
        if !(1..=4096).contains(&outputs) {
            return Err(self.fail(format!("{bias}: found {outputs} values, expected 1 to 4096")));
        }
        Ok(Layer { weight: self.values(&weight, &[inputs, outputs])?, bias: self.values(&bias, &[outputs])? })
    }

    fn values(&self, tensor: &str, shape: &[usize]) -> Result<Vec<f32>, NlosError> {
        let found =
            self.tensors.tensor(tensor).map_err(|_| self.fail(format!("the tensor {tensor} is missing")))?;
        if found.dtype() != Dtype::F32 || found.shape() != shape {
            return Err(self.fail(format!(
                "{tensor}: found {:?} {:?}, expected F32 {shape:?}",
                found.dtype(),
                found.shape()
            )));
        }
        let (values, _) = found.data().as_chunks::<4>();
        let values: Vec<f32> = values.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
        // Levels of a feature may be infinite (no noise at all), never NaN.
        if values.iter().any(|v| v.is_nan()) || (tensor != "normal" && values.iter().any(|v| v.is_infinite()))
        {
            return Err(self.fail(format!("{tensor}: holds a value that is not a finite number")));
        }
        Ok(values)
    }
}
