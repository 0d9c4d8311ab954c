// Makes look-up tables on the device, and packs them for the host.
#pragma once

#include "lut/lut.h"

namespace pel {

// Each throws PEL_ERROR_INVALID_ARGUMENT with the name of the field if a description is outside what
// pellucid.h documents. Work is enqueued, not waited for.
Ref<Lut> integrateCurvatureLut(Ref<Device> device, const PelCurvatureLutDesc& desc);
Ref<Lut> integrateShadowLut(Ref<Device> device, const PelShadowLutDesc& desc);
Ref<Lut> tabulateSpecularLut(Ref<Device> device, const PelSpecularLutDesc& desc);
// From texels that were packed as PEL_LUT_FLOAT; `bytes` is checked against the size in `info`, whose
// description must be valid.
Ref<Lut> uploadLut(Ref<Device> device, const PelLutInfo& info, const float* texels, size_t bytes);

// Makes tables of one kind and size, as many as memory allows by each launch, and packs them one below the
// other, each to the same bits as by itself. Descriptions must be valid; `bytes` is checked. Waits.
void readLutStack(const Ref<Device>& device, std::span<const PelLutInfo> tables, PelLutEncoding encoding,
                  void* destination, size_t bytes);

size_t packedBytes(const Lut& lut, PelLutEncoding encoding);
// Encodes on the device and reads packedBytes() bytes.
void readLut(const Lut& lut, PelLutEncoding encoding, void* destination, bool blocking);

// Texels that PEL_LUT_FACEWORKS8 clips; 0 for other kinds than curvature. Waits.
uint64_t countClipped(const Lut& lut);

// Fill the texels of a table whose description is valid. Enqueued, not waited for.
void integrateTabulatedCurvature(Lut& lut);
void integrateTabulatedShadow(Lut& lut);

}  // namespace pel
