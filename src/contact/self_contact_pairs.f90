!> Self contact within general contact: bodies whose faces can meet other faces of the same body, and faces that met without a pair.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Two faces of a body *face each other* if their normals oppose and each is in front of the other, as across a slot. The pair of a
!! body has the faces that face each other within the way that the nodes can move in the steps, and an edge more. A body of rubber
!! or foam, or with REACH any body, *folds* if that way is as long as the half circle around its thickness, 2 V/A: then all its
!! faces can meet. One pair for each body has these faces, as slave and as master (amontons_self_contact_visibility).
!!
!! Faces that met against this estimate are found after each increment; neighbours on the surface and the two sides of the same
!! material do not count.
module amontons_self_contact_pairs
  use amontons_kinds, only: DP, PI
  use amontons_text, only: to_text, plural, NEWLINE
  use amontons_model, only: model_type
  use amontons_materials, only: ELASTIC_HYPER, ELASTIC_FOAM
  use amontons_element_kinds, only: has_midsides
  use amontons_surfaces, only: surface_type, contact_pair_type, is_compliant
  use amontons_facets, only: facets_type
  use amontons_facet_search, only: facet_search_type, build_facet_search, find_near_facets
  use amontons_exterior_surface, only: exterior_type, measure_faces
  use amontons_mortar_segmentation, only: MIN_FACING_COSINE
  use amontons_contact_pairs, only: MAX_DEPTH_SHARE
  use amontons_general_contact, only: general_pairs_type, face_data_type, build_model_exterior, collect_face_data, &
    estimate_motion, find_interaction, make_surface, body_name, list_facets, exterior_positions, displacement_span
  implicit none
  private
  public :: add_self_pairs, find_unpaired_self_contact

  integer, parameter :: MAX_COMPARED_FACES = 2000           !< faces of a body that each of its faces is compared with
  real(DP), parameter :: FOLD_RATIO = 0.5_DP * PI           !< way of a body that folds, over its thickness [-]
  real(DP), parameter :: NEIGHBOUR_RATIO = 1.5_DP           !< nearer faces, over their edge, are neighbours on the surface [-]

contains

  !> Adds the pairs of bodies that may touch themselves, and a line for each to the text.
  subroutine add_self_pairs(model, found, text)
    type(model_type), intent(in) :: model
    type(general_pairs_type), intent(inout) :: found
    character(:), allocatable, intent(inout) :: text
    type(exterior_type) :: exterior
    type(face_data_type) :: data
    integer, allocatable :: own(:), interaction(:)
    real(DP) :: motion
    integer :: b, f, i
    if (.not. allocated(model%general_contact)) return
    motion = estimate_motion(model)
    call build_model_exterior(model, exterior)
    call collect_face_data(model, exterior, data)
    do b = 1, exterior%n_bodies
      own = pack([(f, f=1, exterior%n)], exterior%body == b .and. .not. data%is_rigid)
      if (size(own) == 0) cycle
      if (motion >= FOLD_RATIO * body_thickness(exterior, own) .and. (model%general_contact%reach > 0.0_DP .or. &
        all(is_rubber(exterior%element(own))))) then
        interaction = [(find_interaction(model%general_contact, data, data%group(own(i)), data%group(own(i)), 0), i=1, size(own))]
      else
        call find_facing_faces(model, exterior, data, own, motion, interaction)
      end if
      do while (any(interaction > 0))
        call append_self_pair(model, exterior, data, own, interaction, found, text)
      end do
    end do

  contains

    !> Whether the material of an element is rubber or foam.
    elemental logical function is_rubber(e)
      integer, intent(in) :: e
      is_rubber = .false.
      if (model%mesh%material(e) > 0) is_rubber = any(model%materials(model%mesh%material(e))%elastic_kind == &
        [ELASTIC_HYPER, ELASTIC_FOAM])
    end function is_rubber

  end subroutine add_self_pairs


  !> The mean thickness of a body, 2 V/A: of a sheet its thickness, of a cube a third of its edge. Method: divergence theorem.
  pure real(DP) function body_thickness(exterior, own) result(thickness)
    type(exterior_type), intent(in) :: exterior
    integer, intent(in) :: own(:)                  !< faces of the body
    real(DP) :: middle(3), n_dimensions
    integer :: i
    middle = sum(exterior%centre(:, own), dim=2) / real(size(own), DP)
    n_dimensions = merge(2.0_DP, 3.0_DP, all(exterior%n_corners(own) == 2))
    thickness = 0.0_DP
    do i = 1, size(own)
      thickness = thickness + exterior%area(own(i)) * dot_product(exterior%centre(:, own(i)) - middle, exterior%normal(:, own(i)))
    end do
    thickness = abs(2 * thickness / n_dimensions / sum(exterior%area(own)))
  end function body_thickness


  !> The interaction of each face of a body with a face that it faces; 0: it faces none.
  subroutine find_facing_faces(model, exterior, data, own, motion, interaction)
    type(model_type), intent(in) :: model
    type(exterior_type), intent(in) :: exterior
    type(face_data_type), intent(in) :: data
    integer, intent(in) :: own(:)                  !< faces of the body
    real(DP), intent(in) :: motion                 !< [length]
    integer, allocatable, intent(out) :: interaction(:)   !< of the faces of the body
    integer :: i, k, stride
    allocate (interaction(size(own)), source=0)
    stride = 1 + size(own) / MAX_COMPARED_FACES
    do i = 1, size(own)
      do k = 1 + modulo(i, stride), size(own), stride
        if (.not. face_each_other(exterior, own(i), own(k), motion)) cycle
        interaction(i) = find_interaction(model%general_contact, data, data%group(own(i)), data%group(own(k)), 0)
        if (interaction(i) > 0) exit
      end do
    end do
  end subroutine find_facing_faces


  !> Whether two faces face each other within the motion and an edge.
  pure logical function face_each_other(exterior, f, m, motion)
    type(exterior_type), intent(in) :: exterior
    integer, intent(in) :: f, m                    !< faces
    real(DP), intent(in) :: motion                 !< [length]
    real(DP) :: between(3), edge
    face_each_other = .false.
    if (dot_product(exterior%normal(:, f), exterior%normal(:, m)) > -MIN_FACING_COSINE) return
    edge = max(exterior%edge_length(f), exterior%edge_length(m))
    between = max(0.0_DP, exterior%box(:, 1, m) - exterior%box(:, 2, f), exterior%box(:, 1, f) - exterior%box(:, 2, m))
    if (norm2(between) > motion + edge) return
    between = exterior%centre(:, m) - exterior%centre(:, f)
    face_each_other = min(dot_product(between, exterior%normal(:, f)), -dot_product(between, exterior%normal(:, m))) > 0.0_DP
  end function face_each_other


  !> Appends the pair of the faces with the first interaction that is left, and removes them from the list.
  subroutine append_self_pair(model, exterior, data, own, interaction, found, text)
    type(model_type), intent(in) :: model
    type(exterior_type), intent(in) :: exterior
    type(face_data_type), intent(in) :: data
    integer, intent(in) :: own(:)                  !< faces of the body
    integer, intent(inout) :: interaction(:)       !< of each; 0: none is left
    type(general_pairs_type), intent(inout) :: found
    character(:), allocatable, intent(inout) :: text
    type(contact_pair_type) :: pair
    type(surface_type) :: surface
    character(:), allocatable :: obstacle
    integer :: law
    law = interaction(findloc(interaction > 0, .true., dim=1))
    call make_surface(model, exterior, data, pack(own, interaction == law), surface)
    surface%name = body_name(model, exterior, exterior%body(own(1))) // '#SELF'
    where (interaction == law) interaction = 0
    text = text // NEWLINE // '  ' // surface%name // ' (' // plural(size(surface%face), 'face') // ')'
    obstacle = self_contact_obstacle(model, surface%element, law)
    if (obstacle /= '') then
      text = text // ' may touch itself, but has no pair for that: ' // obstacle
      return
    end if
    found%surfaces = [found%surfaces, surface]
    pair%is_general = .true.
    pair%is_mortar = model%general_contact%is_mortar
    pair%interaction = law
    pair%slave = size(model%surfaces) + size(found%surfaces)
    pair%master = pair%slave
    pair%name = surface%name // ' / ' // surface%name
    found%pairs = [found%pairs, pair]
    text = text // ' touches itself, interaction ' // model%interactions(law)%name // '.'
  end subroutine append_self_pair


  !> Why elements have no self contact, with what to do; '': they can have it.
  function self_contact_obstacle(model, elements, law) result(text)
    type(model_type), intent(in) :: model
    integer, intent(in) :: elements(:)
    integer, intent(in) :: law                     !< interaction
    character(:), allocatable :: text
    text = ''
    if (is_compliant(model%interactions(law))) then
      text = 'the interaction ' // model%interactions(law)%name // ' is not hard. Name two surfaces with *CONTACT PAIR.'
    else if (.not. model%general_contact%is_mortar .and. any(has_midsides(model%mesh%kind(elements)))) then
      text = 'contact at nodes would keep edges with mid-side nodes straight. Give *CONTACT, TYPE=SURFACE TO SURFACE.'
    end if
  end function self_contact_obstacle


  !> Whether faces of one body have met without a pair, or will do so in an increment like the last one: message names them.
  !! Displacements that differ by less than an element is wide cost nothing.
  subroutine find_unpaired_self_contact(model, u, du, message)
    type(model_type), intent(in) :: model
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) of the last increment; zero without NLGEOM [length]
    character(:), allocatable, intent(out) :: message   !< '': none
    type(exterior_type) :: exterior, now
    type(face_data_type) :: data
    type(facets_type) :: facets
    type(facet_search_type) :: search
    integer, allocatable :: list(:)
    real(DP) :: reach
    integer :: f, k, m, n
    message = ''
    if (.not. allocated(model%general_contact)) return
    if (displacement_span(model, u) < 0.5_DP * smallest_width(model)) return
    call build_model_exterior(model, exterior)
    if (exterior%n == 0) return
    call collect_face_data(model, exterior, data)
    now = exterior
    call measure_faces(model%mesh, model%mesh%coordinates + u, now)
    reach = min(displacement_span(model, du), maxval(now%edge_length)) + 0.25_DP * maxval(now%edge_length)
    call list_facets(now%n, facets)
    call build_facet_search(facets, exterior_positions(now, [(f, f=1, now%n)]), reach, search)
    do f = 1, now%n
      if (data%is_rigid(f)) cycle
      call find_near_facets(search, now%centre(:, f), list, n)
      do k = 1, n
        m = list(k)
        if (now%body(m) /= now%body(f)) cycle
        if (.not. meet(exterior, now, f, m, mean_motion(now, f, du) - mean_motion(now, m, du))) cycle
        if (find_interaction(model%general_contact, data, data%group(f), data%group(m), 0) == 0) cycle
        if (have_pair(model, exterior, f, m)) cycle
        call describe_unpaired_faces(model, exterior, data, f, m, message)
        return
      end do
    end do
  end subroutine find_unpaired_self_contact


  !> The least extent of an element: of its box the longest side [length].
  pure real(DP) function smallest_width(model) result(width)
    type(model_type), intent(in) :: model
    integer :: e
    width = huge(1.0_DP)
    do e = 1, model%mesh%n_elements
      associate (x => model%mesh%coordinates(:, model%mesh%nodes(model%mesh%first(e):model%mesh%first(e + 1) - 1)))
        if (size(x, 2) > 2) width = min(width, maxval(maxval(x, dim=2) - minval(x, dim=2)))
      end associate
    end do
  end function smallest_width


  !> The mean motion of the corners of a face [length].
  pure function mean_motion(exterior, f, du) result(motion)
    type(exterior_type), intent(in) :: exterior
    integer, intent(in) :: f                       !< face
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) [length]
    real(DP) :: motion(3)
    motion = sum(du(:, exterior%nodes(exterior%first(f):exterior%first(f) + exterior%n_corners(f) - 1)), dim=2) &
      / real(exterior%n_corners(f), DP)
  end function mean_motion


  !> Whether two faces of a body meet: opposite each other now, with a gap that the motion of the last increment would close, or
  !! with a penetration. Neighbours on the surface and the two sides of the same material do not meet.
  pure logical function meet(exterior, now, f, m, motion)
    type(exterior_type), intent(in) :: exterior    !< at the start
    type(exterior_type), intent(in) :: now
    integer, intent(in) :: f, m                    !< faces
    real(DP), intent(in) :: motion(3)              !< of f towards m in the last increment [length]
    real(DP) :: between(3), front, edge
    meet = .false.
    if (dot_product(now%normal(:, f), now%normal(:, m)) > -MIN_FACING_COSINE) return
    edge = max(now%edge_length(f), now%edge_length(m))
    between = now%centre(:, m) - now%centre(:, f)
    front = min(dot_product(between, now%normal(:, f)), -dot_product(between, now%normal(:, m)))
    if (front > max(0.0_DP, dot_product(motion, now%normal(:, f)))) return
    if (front < -MAX_DEPTH_SHARE * min(now%depth(f), now%depth(m))) return
    if (norm2(between - dot_product(between, now%normal(:, f)) * now%normal(:, f)) > 0.5_DP * edge) return
    between = exterior%centre(:, m) - exterior%centre(:, f)
    if (dot_product(exterior%normal(:, f), exterior%normal(:, m)) > -MIN_FACING_COSINE) then
      meet = norm2(between) > (NEIGHBOUR_RATIO + 1) * edge
    else
      front = min(dot_product(between, exterior%normal(:, f)), -dot_product(between, exterior%normal(:, m)))
      meet = front > 0.0_DP .or. norm2(between - dot_product(between, exterior%normal(:, f)) * exterior%normal(:, f)) > 2 * edge
    end if
  end function meet


  !> Whether some pair of the model has one of two faces as slave and the other one as master.
  pure logical function have_pair(model, exterior, f, m)
    type(model_type), intent(in) :: model
    type(exterior_type), intent(in) :: exterior
    integer, intent(in) :: f, m                    !< faces
    integer :: p
    have_pair = .false.
    do p = 1, size(model%pairs)
      associate (slave => model%surfaces(model%pairs(p)%slave), master => model%surfaces(model%pairs(p)%master))
        have_pair = have_pair .or. (has_face(slave, f) .and. has_face(master, m))
        have_pair = have_pair .or. (has_face(slave, m) .and. has_face(master, f))
      end associate
    end do

  contains

    !> Whether a surface has a face.
    pure logical function has_face(surface, i)
      type(surface_type), intent(in) :: surface
      integer, intent(in) :: i
      has_face = .false.
      if (allocated(surface%element)) has_face = any(surface%element == exterior%element(i) .and. surface%face == exterior%face(i))
    end function has_face

  end function have_pair


  !> The sentence about two faces of a body that met, with what helps.
  subroutine describe_unpaired_faces(model, exterior, data, f, m, message)
    type(model_type), intent(in) :: model
    type(exterior_type), intent(in) :: exterior
    type(face_data_type), intent(in) :: data
    integer, intent(in) :: f, m                    !< faces
    character(:), allocatable, intent(out) :: message
    character(:), allocatable :: obstacle
    integer :: i, law
    law = find_interaction(model%general_contact, data, data%group(f), data%group(m), 0)
    message = 'General contact: element ' // to_text(model%mesh%element_label(exterior%element(f))) // ' of ' // body_name(model, &
      exterior, exterior%body(f)) // ' reached element ' // to_text(model%mesh%element_label(exterior%element(m))) // &
      ' of the same body, and there is no pair of them: '
    obstacle = self_contact_obstacle(model, exterior%element([f, m]), law)
    if (obstacle /= '') then
      message = message // obstacle
    else
      message = message // 'they were not near at the start. Give *CONTACT a REACH of ' // to_text(FOLD_RATIO &
        * body_thickness(exterior, pack([(i, i=1, exterior%n)], exterior%body == exterior%body(f)))) // &
        ' or more, or *CONTACT PAIR with one surface that has both.'
    end if
  end subroutine describe_unpaired_faces

end module amontons_self_contact_pairs
