// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// A team of lanes and how they talk: by subgroup shuffles, or through shared memory with one barrier for each exchange,
// where a device has no shuffles or its subgroups are smaller than a team.
#ifdef CAIRN_SHUFFLE
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require
#extension GL_KHR_shader_subgroup_shuffle_relative : require

uint lane() { return gl_SubgroupInvocationID % kTeam; }
uint team() { return (gl_SubgroupID * gl_SubgroupSize + gl_SubgroupInvocationID) / kTeam; }
uint of_lane_before(uint value) { return subgroupShuffleUp(value, 1); }
uint of_lane_after(uint value) { return subgroupShuffleDown(value, 1); }
#define CAIRN_OVER_TEAM(name, combine)                                                  \
  uint name(uint value) {                                                               \
    for (uint apart = kTeam / 2; apart > 0; apart /= 2) {                               \
      const uint other = subgroupShuffleXor(value, apart);                              \
      value = combine;                                                                  \
    }                                                                                   \
    return value;                                                                       \
  }
#else
// The two halves take turns: nobody overwrites a slot before all have passed the next barrier, after reading it.
shared uint said[2][kGroup];
uint half_in_use = 0;

uint lane() { return gl_LocalInvocationIndex % kTeam; }
uint team() { return gl_LocalInvocationIndex / kTeam; }
void say(uint value) {
  half_in_use ^= 1;
  said[half_in_use][gl_LocalInvocationIndex] = value;
  barrier();
}
uint of_lane_before(uint value) {
  say(value);
  return said[half_in_use][max(gl_LocalInvocationIndex, 1) - 1];
}
uint of_lane_after(uint value) {
  say(value);
  return said[half_in_use][min(gl_LocalInvocationIndex + 1, kGroup - 1)];
}
#define CAIRN_OVER_TEAM(name, combine)                                                  \
  uint name(uint value) {                                                               \
    say(value);                                                                         \
    const uint first = gl_LocalInvocationIndex - lane();                                \
    value = said[half_in_use][first];                                                   \
    for (uint i = 1; i < kTeam; ++i) {                                                  \
      const uint other = said[half_in_use][first + i];                                  \
      value = combine;                                                                  \
    }                                                                                   \
    return value;                                                                       \
  }
#endif
CAIRN_OVER_TEAM(least_of_team, min(value, other))
CAIRN_OVER_TEAM(bits_of_team, value & other)
CAIRN_OVER_TEAM(sum_of_team, value + other)

/// The number of the path of this team, of `count`. Spare teams repeat the last one and write nothing, so that all lanes
/// of a group meet the same barriers.
int path_of_team(int count, out bool writes) {
  const int number = int(gl_WorkGroupID.x * (kGroup / kTeam) + team());
  writes = number < count;
  return min(number, count - 1);
}
