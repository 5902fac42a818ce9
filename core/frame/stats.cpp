// SPDX-License-Identifier: GPL-3.0-or-later
#include "frame/stats.h"

#include <nlohmann/json.hpp>

namespace kestrel {
namespace {

using Json = nlohmann::ordered_json;

Json unit_json(const Unit& unit, const UnitSelection& s) {
  Json effects = Json::array();
  if (s.effects & kShadows) effects.push_back("shadows");
  if (s.effects & kReflections) effects.push_back("reflections");
  if (s.effects & kRefractions) effects.push_back("refractions");
  return {{"name", unit.name},
          {"area_px", s.area},
          {"P", s.centrality},
          {"D", s.distance},
          {"V", s.visibility},
          {"Q", s.rays},
          {"E", s.estimated_cost},
          {"K", unit.settings.relevance},
          {"cost", s.cost},
          {"relevance", s.relevance},
          {"was_selected", s.was_selected},
          {"selected", s.selected},
          {"effects", effects},
          {"tracer", s.effects ? "embree" : "none"},
          {"ms", s.ms},
          {"rays", s.traced_rays}};
}

}  // namespace

StageTimes& StageTimes::operator+=(const StageTimes& o) {
  update += o.update;
  raster += o.raster;
  heuristic += o.heuristic;
  trace += o.trace;
  blend += o.blend;
  return *this;
}

StageTimes operator*(const StageTimes& t, double factor) {
  return {t.update * factor, t.raster * factor, t.heuristic * factor, t.trace * factor,
          t.blend * factor};
}

std::string to_json(const FrameStats& stats, const Scene& scene) {
  Json objects = Json::array();
  for (size_t i = 0; i < stats.selection.units.size(); ++i) {
    objects.push_back(unit_json(scene.units[i], stats.selection.units[i]));
    if (!stats.occlusion_areas.empty()) {
      objects.back()["area_occlusion_px"] = stats.occlusion_areas[i];
    }
  }
  const Json frame = {{"frame_ms", stats.frame_ms},
                      {"stages_ms",
                       {{"update", stats.stages.update},
                        {"raster", stats.stages.raster},
                        {"heuristic", stats.stages.heuristic},
                        {"trace", stats.stages.trace},
                        {"blend", stats.stages.blend}}},
                      {"primary", stats.primary},
                      {"samples", stats.samples},
                      {"rays",
                       {{"primary", stats.rays.primary},
                        {"shadow", stats.rays.shadow},
                        {"reflection", stats.rays.reflection},
                        {"refraction", stats.rays.refraction}}},
                      {"trace_calls_ms", stats.trace_calls_ms},
                      {"budget_ms", scene.settings.budget_ms},
                      {"objects", objects}};
  return frame.dump();
}

}  // namespace kestrel
