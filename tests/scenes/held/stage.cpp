// SPDX-License-Identifier: MIT
#include "tests/scenes/held/stage.hpp"

#include <cmath>

namespace hapticast::evaluate::held {

namespace {

Color mixed(const Color& a, const Color& b, double share) {
  return a + static_cast<float>(share) * (b - a);
}

// Skins from light to dark; what is drawn lies between two of them.
Color skinTone(Draw& draw) {
  const Color tones[] = {screen(238, 196, 172), screen(224, 172, 138), screen(198, 140, 100),
                         screen(150, 98, 66),   screen(104, 66, 46),   screen(72, 46, 36)};
  const double at = draw.between(0.0, 4.999);
  const auto low = static_cast<std::size_t>(at);
  return mixed(tones[low], tones[low + 1], at - double(low));
}

}  // namespace

Color screen(double red, double green, double blue) {
  const auto linear = [](double level) { return static_cast<float>(std::pow(level / 255.0, 2.2)); };
  return {linear(blue), linear(green), linear(red)};
}

Color anyColor(Draw& draw) {
  const double hue = draw.between(0.0, 6.0);
  const double strong = draw.chance(0.35) ? draw.between(0.0, 0.15) : draw.between(0.15, 0.65);
  const double light = draw.between(60.0, 215.0);
  const auto channel = [&](double from) {
    const double off = std::abs(std::fmod(hue - from + 9.0, 6.0) - 3.0);  // 0 at the hue itself
    return light * (1.0 - strong * std::fmin(1.0, std::fmax(0.0, off - 1.0)));
  };
  return screen(channel(0.0), channel(2.0), channel(4.0));
}

Stage::Stage(std::string name, const StagePlan& plan, std::uint64_t seed) : draw(seed) {
  scene.name = std::move(name);
  mirror = draw.chance(0.5) ? -1.0 : 1.0;
  const double pitch = plan.pitch_rad + draw.between(-0.07, 0.07);
  const double distance = plan.distance_mm * draw.between(0.94, 1.06);
  const double c = std::cos(pitch);
  const double s = std::sin(pitch);
  to_camera.turn << 1, 0, 0, 0, -c, s, 0, -s, -c;
  to_camera.at_mm = Vec3(0, 0, distance) - to_camera.turn * Vec3(0, plan.looks_at_mm, 0);
  scene.middle_mm = to_camera.out({0, 60, 0});
  scene.focal_share = draw.between(0.88, 1.0);
  scene.sensing.seed = seed;
  drawLight();
  drawPerson();
  setTable(plan);
  if (plan.clutter) setClutter();
  if (plan.person) setPerson();
}

std::size_t Stage::add(const Paint& paint) {
  scene.paints.push_back(paint);
  return scene.paints.size() - 1;
}

void Stage::place(Thing thing) {
  thing.pose = to_camera * thing.pose;
  scene.room.push_back(std::move(thing));
}

void Stage::drawLight() {
  const double warm = draw.between(-0.12, 0.16);
  const auto w = static_cast<float>(warm);
  scene.light.towards =
      (to_camera.turn * Vec3(draw.between(-0.6, 0.6), 1.0, draw.between(0.1, 0.8))).normalized();
  scene.light.up = to_camera.turn * Vec3::UnitY();
  const auto lamp = static_cast<float>(draw.between(0.55, 0.85));
  const auto around = static_cast<float>(draw.between(0.38, 0.6));
  scene.light.lamp = lamp * Color(1.0F - w, 1.0F, 1.0F + w);
  scene.light.around = around * Color(1.0F - 0.3F * w, 1.0F, 1.0F + 0.3F * w);
}

void Stage::drawPerson() {
  const Color tone = skinTone(draw);
  skin = add({Pattern::kSkin, tone, tone, 20.0, 0.06F, 0.0F});
  fingertip = add({Pattern::kFingertip, tone, tone, 20.0, 0.06F, 0.0F});
  Paint cloth;
  const Pattern patterns[] = {Pattern::kPlain, Pattern::kStripes, Pattern::kChecks,
                              Pattern::kBlotches};
  cloth.pattern = patterns[draw.oneOf(4)];
  cloth.color = anyColor(draw);
  cloth.second = cloth.pattern == Pattern::kPlain ? 0.6F * cloth.color : anyColor(draw);
  cloth.scale_mm = draw.between(14.0, 46.0);
  shirt = add(cloth);
  sleeve = shirt;
}

void Stage::setTable(const StagePlan& plan) {
  Paint top;
  const bool wood = draw.chance(0.5);
  const double level = draw.between(0.6, 1.0);
  top.pattern = wood ? Pattern::kWood : draw.chance(0.5) ? Pattern::kPlain : Pattern::kBlotches;
  top.color = wood ? screen(196 * level, 152 * level, 108 * level)
                   : mixed(screen(200 * level, 200 * level, 196 * level), anyColor(draw), 0.25);
  top.second = wood ? screen(160 * level, 112 * level, 74 * level) : Color(0.82F * top.color);
  const std::size_t table = add(top);
  Thing thing;
  thing.id = kTable;
  const double back = plan.person ? 330.0 : 900.0;
  thing.parts.push_back(
      makePart(Form::kBox, {800, 15, 0.5 * (700 + back)}, {0, -15, 0.5 * (700 - back)}, table));
  place(thing);
  Paint shelf;
  shelf.pattern = Pattern::kShelf;
  shelf.color = screen(120, 96, 74);
  shelf.second = screen(225, 220, 205);
  shelf.scale_mm = draw.between(26.0, 40.0);
  const Color wall_color = mixed(screen(205, 205, 200), anyColor(draw), 0.15);
  const std::size_t plain = add({Pattern::kPlain, wall_color, wall_color, 40.0, 0.0F, 0.0F});
  const std::size_t books = add(shelf);
  const double away = draw.between(1300.0, 2100.0);
  Thing wall;
  wall.id = kRoom;
  wall.parts.push_back(makePart(Form::kBox, {4000, 3000, 20}, {0, 0, -away}, plain));
  wall.parts.push_back(makePart(Form::kBox, {520, 900, 120},
                                at(draw.between(-900, 900), 300, -away + 60), books, 1));
  wall.parts.push_back(makePart(Form::kBox, {4000, 20, 4000}, {0, -760, 0}, plain, 2));
  place(wall);
}

void Stage::setClutter() {
  Thing things;
  things.id = kOther;
  int group = 0;
  const auto add_thing = [&](Part one, double yaw) {
    one.group = group++;
    one.pose.turn = Eigen::AngleAxisd(yaw, Vec3::UnitY()).toRotationMatrix() * one.pose.turn;
    things.parts.push_back(one);
  };
  const auto painted = [&](Pattern pattern, float gloss) {
    return add({pattern, anyColor(draw), anyColor(draw), 18.0, gloss, 0.0F});
  };
  // Books and a can to the left and far right, paper and a pencil in front.
  add_thing(makePart(Form::kBox, {70, 14, 100}, at(-260 + draw.between(-30, 30), 14, -90),
                     painted(Pattern::kStripes, 0.1F)),
            draw.between(-0.5, 0.5));
  add_thing(makePart(Form::kBox, {60, 9, 84}, at(-262, 37, -86), painted(Pattern::kPlain, 0.1F)),
            draw.between(-0.6, 0.6));
  add_thing(makePart(Form::kCylinder, {30, 50, 0}, at(235 + draw.between(-20, 40), 50, -190),
                     painted(Pattern::kDots, 0.3F)),
            0.0);
  add_thing(
      makePart(Form::kBox, {74, 1.2, 105}, at(-190, 1.2, 130), painted(Pattern::kPlain, 0.0F)),
      draw.between(-0.7, 0.7));
  add_thing(makePart(Form::kEllipsoid, {36, 34, 36}, at(-170, 34, -215),
                     painted(Pattern::kBlotches, 0.25F)),
            0.0);
  place(things);
}

void Stage::setPerson() {
  const double x = mirror * draw.between(-60, 60);
  const double z = -470.0 + draw.between(-30, 30);
  person_mm = {x, 0, z};
  Thing person;
  person.id = kPerson;
  person.blend_mm = 30.0;
  auto& parts = person.parts;
  parts.push_back(makePart(Form::kEllipsoid, {165, 300, 105}, {x, 120, z}, shirt));
  parts.push_back(makeLimb({x - 150, 350, z - 10}, {x + 150, 350, z - 10}, 62, 62, shirt));
  for (const double side : {-1.0, 1.0}) {
    const Vec3 shoulder(x + side * 180, 352, z - 10);
    const Vec3 elbow(x + side * 235, 70, z + 110);
    parts.push_back(makeLimb(shoulder, elbow, 56, 44, shirt));
  }
  parts.push_back(makeLimb({x, 390, z}, {x, 460, z + 8}, 52, 50, skin));
  const std::size_t hair =
      add({Pattern::kFur, screen(70, 50, 38), screen(24, 18, 14), 10, 0, 0.3F});
  const std::size_t eye = add({Pattern::kPlain, screen(40, 32, 30), screen(0, 0, 0), 10, 0.2F, 0});
  const std::size_t lip = add({Pattern::kPlain, screen(150, 80, 76), screen(0, 0, 0), 10, 0, 0});
  parts.push_back(makePart(Form::kEllipsoid, {74, 104, 88}, {x, 555, z + 10}, skin, 1));
  parts.push_back(makeLimb({x, 565, z + 92}, {x, 540, z + 106}, 9, 13, skin, 1));
  parts.push_back(makePart(Form::kEllipsoid, {82, 88, 92}, {x, 592, z - 14}, hair, 2));
  for (const double side : {-1.0, 1.0})
    parts.push_back(makePart(Form::kEllipsoid, {11, 6, 6}, {x + side * 30, 568, z + 87}, eye, 3));
  parts.push_back(makePart(Form::kEllipsoid, {24, 7, 8}, {x, 500, z + 84}, lip, 3));
  place(person);
}

HandScript Stage::hand(std::uint8_t id, bool right, const Vec3& elbow_mm) {
  HandScript out;
  out.id = id;
  out.look.right = (mirror > 0) == right;
  out.look.scale = draw.between(0.9, 1.06);
  out.look.skin = skin;
  out.look.fingertip = fingertip;
  out.look.sleeve = sleeve;
  out.look.has_sleeve = draw.chance(0.65);
  out.look.sleeve_from = draw.between(0.1, 0.55);
  out.elbow_mm = to_camera.out(elbow_mm);
  return out;
}

std::size_t Stage::addPaintsOf(Kind kind) {
  const Color main = anyColor(draw);
  const Color other = anyColor(draw);
  const auto pick = [&](std::initializer_list<Pattern> of) {
    return *(of.begin() + static_cast<std::ptrdiff_t>(draw.oneOf(of.size())));
  };
  Paint first{Pattern::kPlain, main, other, 20.0, 0.1F, 0.0F};
  Paint second = first;
  Paint third{Pattern::kPlain, screen(18, 16, 16), screen(40, 36, 34), 10.0, 0.5F, 0.9F};
  switch (kind) {
    case Kind::kMug:
      first.pattern = pick({Pattern::kPlain, Pattern::kDots, Pattern::kStripes, Pattern::kLabel});
      first.scale_mm = first.pattern == Pattern::kLabel ? 20.0 : draw.between(16.0, 30.0);
      first.gloss = 0.8F;
      break;
    case Kind::kBear: {
      const Color furs[] = {screen(150, 104, 66), screen(205, 170, 128), screen(110, 96, 90),
                            screen(226, 218, 204), main};
      first = {Pattern::kFur, furs[draw.oneOf(5)], main, 10.0, 0.0F, 0.05F};
      first.second = 0.55F * first.color;
      second = {Pattern::kFur, screen(236, 228, 214), screen(206, 190, 168), 10.0, 0.0F, 0.45F};
      break;
    }
    case Kind::kBall:
      first.pattern = pick({Pattern::kBlotches, Pattern::kStripes, Pattern::kPlain});
      first.scale_mm = 32.0;
      first.gloss = 0.25F;
      break;
    case Kind::kBox:
    case Kind::kTablet:
      first.pattern = pick({Pattern::kLabel, Pattern::kDots, Pattern::kChecks, Pattern::kPlain});
      first.scale_mm = 28.0;
      first.gloss = 0.15F;
      break;
    case Kind::kTube:
      first.pattern = pick({Pattern::kPlain, Pattern::kBlotches});
      break;
    case Kind::kBottle:
      first.pattern = Pattern::kLabel;
      first.scale_mm = 30.0;
      first.gloss = second.gloss = 0.7F;
      third = {Pattern::kPlain, other, other, 10.0, 0.4F, 0.0F};
      break;
  }
  const std::size_t at = add(first);
  add(second);
  add(third);
  add(third);
  return at;
}

}  // namespace hapticast::evaluate::held
