!> Search after each increment for faces that have come together without a contact pair, of two bodies or of one.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! General contact makes pairs of the faces that are near at the start. The search finds faces that have moved farther, and, at
!! small displacements too, those that *MODEL CHANGE uncovered or added, which have no pairs. Cost: none while nothing moved that
!! far; else linear in the exterior faces, whose data are built once, and again for a step with other faces.
module amontons_unpaired_contact
  use amontons_kinds, only: DP
  use amontons_text, only: to_text
  use amontons_containers, only: integer_list_type, list_groups, owners_of_entries
  use amontons_model, only: model_type, absent_elements
  use amontons_exterior_membership, only: find_uncounted_elements
  use amontons_facets, only: facets_type
  use amontons_facet_search, only: facet_search_type, build_facet_search, find_near_facets
  use amontons_exterior_surface, only: exterior_type, measure_faces, reached_depth, is_thin
  use amontons_mortar_segmentation, only: MIN_FACING_COSINE
  use amontons_contact_pairs, only: SEARCH_RADIUS_RATIO, MAX_DEPTH_SHARE
  use amontons_body_motion, only: estimate_motion, displacement_span, body_thickness, FOLD_RATIO
  use amontons_general_contact, only: face_data_type, near_faces_type, build_model_exterior, collect_face_data, &
    find_near_faces, find_interaction, body_name, TOUCHING_RADIUS, is_rigid_sheet
  use amontons_face_proximity, only: list_facets, exterior_positions, box_distance
  use amontons_self_contact_pairs, only: self_contact_obstacle
  implicit none
  private
  public :: model_faces_type, find_unpaired_contact, find_unpaired_self_contact
  public :: place_faces, smallest_width, have_pair, other_side, is_new

  real(DP), parameter :: TURNED_RATIO = 0.5_DP              !< motion that turns a face by less than 60 degrees, over its edge [-]
  real(DP), parameter :: NEIGHBOUR_RATIO = 1.5_DP           !< nearer faces, over their edge, are neighbours on the surface [-]
  integer, parameter :: MAX_FACES = 6                       !< of an element

  !> The exterior of the model in a step, for the search of unpaired faces after each increment; made when a search needs it first,
  !! and again in a step with other faces.
  type :: model_faces_type
    logical, allocatable :: is_uncounted(:)        !< (n_elements) elements without faces; unallocated: nothing is made yet
    logical, allocatable :: is_new(:)              !< (n) a face that the first step does not have; unallocated: none
    real(DP) :: motion = -1                        !< way that the pairs allow for; negative: not known yet [length]
    real(DP) :: least_width = -1                   !< least extent of an element; negative: not known yet [length]
    type(exterior_type) :: exterior                !< at the start
    type(exterior_type) :: now                     !< at the displacements placed_u
    real(DP), allocatable :: placed_u(:, :)        !< (3, n_nodes) [length]
    type(face_data_type) :: data
    integer, allocatable :: slave_first(:), slave_pair(:)     !< pairs of which each face is a slave, in compressed lists
    integer, allocatable :: master_first(:), master_pair(:)   !< the same for masters
    integer, allocatable :: node_first(:), node_face(:)       !< faces of which each node is a corner, in compressed lists
    real(DP), allocatable :: checked_u(:, :)       !< (3, n_nodes) displacements at the last crossing check [length]
    real(DP), allocatable :: clear_u(:, :)         !< (3, n_nodes) the same, with no driven sheets near each other [length]
    logical, allocatable :: may_cross(:, :)        !< (n_bodies, n_bodies) they crossed at the start or while a pair was removed
    logical :: is_free_of_crossings = .false.      !< the last attempt was checked for crossings, and there was none
  end type model_faces_type

contains

  !> Whether bodies that moved farther than the search looked touch each other without a pair, or may do so in an increment
  !! like the last one: message says which faces. Displacements that differ by less than the motion cost nothing; if it is long,
  !! the faces of the pairs were chosen by their normals at the start, and only those by which no face can have turned far.
  subroutine find_unpaired_contact(model, faces, u, du, step, message)
    type(model_type), intent(in) :: model
    type(model_faces_type), intent(inout) :: faces !< prepared here if needed
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) of the last increment; zero without NLGEOM [length]
    integer, intent(in) :: step                    !< of the model, from 1
    character(:), allocatable, intent(out) :: message   !< '': none
    type(near_faces_type) :: near
    logical :: is_absent(model%mesh%n_elements), is_far
    real(DP) :: span, approach
    integer :: i, n_met
    message = ''
    if (.not. allocated(model%general_contact)) return
    span = displacement_span(model, u)
    if (faces%motion < 0.0_DP) faces%motion = estimate_motion(model)
    if (faces%least_width < 0.0_DP) faces%least_width = smallest_width(model)
    is_far = model%steps(step)%is_nlgeom .and. span > min(faces%motion, TURNED_RATIO * faces%least_width) .and. &
      (faces%motion > SEARCH_RADIUS_RATIO * faces%least_width .or. span > faces%motion)
    is_absent = absent_elements(model, step)
    if (.not. is_far) then
      if (.not. (any(is_absent .neqv. absent_elements(model, 1)))) return
    end if
    call place_faces(model, faces, u, step)
    if (.not. (is_far .or. allocated(faces%is_new))) return
    approach = min(displacement_span(model, du), SEARCH_RADIUS_RATIO * maxval(faces%now%edge_length))
    near%has_all_couples = .true.
    call find_near_faces(model%general_contact, faces%now, faces%data, TOUCHING_RADIUS, approach, near)
    n_met = near%face%n
    do i = 1, near%undecided%n, 2                  ! sheets that cross have met, too
      call near%face%add(near%undecided%items(i))
      call near%other%add(near%undecided%items(i + 1))
    end do
    do i = 1, near%face%n
      associate (now => faces%now, f => near%face%items(i), m => near%other%items(i))
        if (are_covered(faces, f, m) .or. any(is_absent(now%element([f, m])))) cycle
        if (.not. (is_far .or. is_new(faces, f) .or. is_new(faces, m))) cycle
        if (i > n_met) exit
        if (may_meet(now, f, m, mean_motion(now, f, du) - mean_motion(now, m, du))) exit
      end associate
    end do
    if (i > near%face%n) return
    associate (mesh => model%mesh, now => faces%now, f => near%face%items(i), m => near%other%items(i))
      message = 'General contact: element ' // to_text(mesh%element_label(now%element(f))) // ' of ' // &
        body_name(model, now, now%body(f)) // ' reached ' // body_name(model, now, now%body(m))
      if (is_new(faces, f) .or. is_new(faces, m)) then
        message = message // ' where *MODEL CHANGE uncovered or added faces, and there is no pair of them. Name the pair with ' // &
          '*CONTACT PAIR, or both bodies in *CONTACT EXCLUSIONS.'
      else
        message = message // ', from which it was too far or turned away at the start, and there is no pair of them. Give ' // &
          '*CONTACT a REACH of more than ' // to_text(span) // ', or name the pair with *CONTACT PAIR.'
      end if
    end associate
  end subroutine find_unpaired_contact


  !> Whether *MODEL CHANGE uncovered or added a face after the first step.
  pure logical function is_new(faces, f)
    type(model_faces_type), intent(in) :: faces
    integer, intent(in) :: f                       !< face; 0: none
    is_new = allocated(faces%is_new) .and. f > 0
    if (is_new) is_new = faces%is_new(f)
  end function is_new


  !> Whether faces of one body have met without a pair, or will do so in an increment like the last one: message names them.
  !! Displacements that differ by less than an element is wide cost nothing.
  subroutine find_unpaired_self_contact(model, faces, u, du, step, message)
    type(model_type), intent(in) :: model
    type(model_faces_type), intent(inout) :: faces !< prepared here if needed
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) of the last increment; zero without NLGEOM [length]
    integer, intent(in) :: step                    !< of the model, from 1
    character(:), allocatable, intent(out) :: message   !< '': none
    logical :: is_absent(model%mesh%n_elements)
    type(facets_type) :: facets
    type(facet_search_type) :: search
    integer, allocatable :: list(:)
    real(DP) :: reach
    integer :: f, k, m, n
    message = ''
    if (.not. allocated(model%general_contact)) return
    if (faces%least_width < 0.0_DP) faces%least_width = smallest_width(model)
    if (displacement_span(model, u) < 0.5_DP * faces%least_width) return
    call place_faces(model, faces, u, step)
    if (faces%exterior%n == 0) return
    is_absent = absent_elements(model, step)
    associate (now => faces%now)
      reach = min(displacement_span(model, du), maxval(now%edge_length)) + 0.25_DP * maxval(now%edge_length)
      call list_facets(now%n, facets)
      call build_facet_search(facets, exterior_positions(now, [(f, f=1, now%n)]), reach, search)
      do f = 1, now%n
        if (faces%data%is_rigid(f)) cycle
        call find_near_facets(search, now%centre(:, f), list, n)
        do k = 1, n
          m = list(k)
          if (now%body(m) /= now%body(f) .or. any(is_absent(now%element([f, m])))) cycle
          if (.not. meet(faces%exterior, now, f, m, mean_motion(now, f, du) - mean_motion(now, m, du))) cycle
          if (find_interaction(model%general_contact, faces%data, faces%data%group(f), faces%data%group(m), 0) == 0) cycle
          if (have_pair(faces, f, m) .or. have_pair(faces, m, f)) cycle
          call describe_unpaired_faces(model, faces%exterior, faces%data, f, m, message)
          return
        end do
      end do
    end associate
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
    front = min(dot_product(between, now%normal(:, f)), -dot_product(between, now%normal(:, m))) - now%height(f) - now%height(m)
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


  !> Whether some pair of the model has a face as slave and another one as master.
  pure logical function have_pair(faces, slave, master)
    type(model_faces_type), intent(in) :: faces
    integer, intent(in) :: slave, master           !< faces
    integer :: i
    have_pair = .false.
    do i = faces%slave_first(slave), faces%slave_first(slave + 1) - 1
      have_pair = have_pair .or. any(faces%master_pair(faces%master_first(master):faces%master_first(master + 1) - 1) == &
        faces%slave_pair(i))
    end do
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


  !> Measures the faces at some displacements; the checks of an increment share the measurement.
  subroutine place_faces(model, faces, u, step)
    type(model_type), intent(in) :: model
    type(model_faces_type), intent(inout) :: faces !< prepared here if needed
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    integer, intent(in) :: step                    !< of the model, from 1
    call prepare_faces(model, faces, step)
    if (allocated(faces%placed_u)) then
      if (all(abs(u - faces%placed_u) <= 0.0_DP)) return
    else
      faces%now = faces%exterior
    end if
    faces%placed_u = u
    call measure_faces(model%mesh, model%mesh%coordinates + u, faces%now)
  end subroutine place_faces


  !> Builds the exterior, the data of its faces and the pairs of each face. Cost: linear in faces and surfaces, once for each set of
  !! elements that count.
  subroutine prepare_faces(model, faces, step)
    type(model_type), intent(in) :: model
    type(model_faces_type), intent(inout) :: faces
    integer, intent(in) :: step                    !< of the model, from 1
    logical :: is_uncounted(model%mesh%n_elements)
    integer, allocatable :: number(:, :), of_entry(:)
    integer :: f, i
    is_uncounted = find_uncounted_elements(model, step)
    if (allocated(faces%is_uncounted)) then
      if (all(is_uncounted .eqv. faces%is_uncounted)) return
    end if
    faces%is_uncounted = is_uncounted
    if (allocated(faces%placed_u)) deallocate (faces%placed_u)
    if (allocated(faces%may_cross)) deallocate (faces%may_cross)
    call build_model_exterior(model, step, faces%exterior)
    call mark_new_faces(model, faces)
    call collect_face_data(model, faces%exterior, faces%data)
    allocate (number(6, model%mesh%n_elements), source=0)
    do f = 1, faces%exterior%n
      number(faces%exterior%face(f), faces%exterior%element(f)) = f
    end do
    call list_pairs_of_faces(model, number, faces%exterior%n, .true., faces%slave_first, faces%slave_pair)
    call list_pairs_of_faces(model, number, faces%exterior%n, .false., faces%master_first, faces%master_pair)
    associate (exterior => faces%exterior)
      of_entry = exterior%nodes
      do f = 1, exterior%n                         ! mid-sides are left out
        of_entry(exterior%first(f) + exterior%n_corners(f):exterior%first(f + 1) - 1) = 0
      end do
      call list_groups(of_entry, model%mesh%n_nodes, faces%node_first, faces%node_face)
      of_entry = owners_of_entries(exterior%first)
      faces%node_face = [(of_entry(faces%node_face(i)), i=1, size(faces%node_face))]
    end associate
  end subroutine prepare_faces


  !> Marks the faces that the exterior of the first step does not have.
  subroutine mark_new_faces(model, faces)
    type(model_type), intent(in) :: model
    type(model_faces_type), intent(inout) :: faces !< with its exterior
    type(exterior_type) :: first
    logical :: is_first(MAX_FACES, model%mesh%n_elements)
    integer :: f
    if (allocated(faces%is_new)) deallocate (faces%is_new)
    if (all(faces%is_uncounted .eqv. find_uncounted_elements(model, 1))) return
    call build_model_exterior(model, 1, first)
    is_first = .false.
    do f = 1, first%n
      is_first(first%face(f), first%element(f)) = .true.
    end do
    faces%is_new = [(.not. is_first(faces%exterior%face(f), faces%exterior%element(f)), f=1, faces%exterior%n)]
  end subroutine mark_new_faces


  !> The pairs that have each face on one side.
  subroutine list_pairs_of_faces(model, number, n_faces, is_slave, first, pair)
    type(model_type), intent(in) :: model
    integer, intent(in) :: number(:, :)            !< (faces, elements) exterior face; 0: none
    integer, intent(in) :: n_faces
    logical, intent(in) :: is_slave                !< the side
    integer, allocatable, intent(out) :: first(:), pair(:)   !< compressed lists
    type(integer_list_type) :: face, owner
    integer, allocatable :: members(:)
    integer :: p, i
    do p = 1, size(model%pairs)
      associate (surface => model%surfaces(merge(model%pairs(p)%slave, model%pairs(p)%master, is_slave)))
        if (.not. allocated(surface%element)) cycle
        do i = 1, size(surface%element)
          call face%add(number(surface%face(i), surface%element(i)))
          call owner%add(p)
        end do
      end associate
    end do
    call list_groups(face%trimmed(), n_faces, first, members)
    pair = owner%items(members)
  end subroutine list_pairs_of_faces


  !> Whether some pair holds two faces, one on each side. Two rigid elements without depth that touch by a penalty have passed each
  !! other by a little: then their other sides are in the pair.
  pure logical function are_covered(faces, f, m)
    type(model_faces_type), intent(in) :: faces
    integer, intent(in) :: f, m                    !< faces
    integer :: g, h
    are_covered = have_pair(faces, f, m) .or. have_pair(faces, m, f)
    if (are_covered .or. .not. all(is_rigid_sheet(faces%exterior, faces%data, [f, m]))) return
    g = other_side(faces%exterior, f)              ! before they touch
    h = other_side(faces%exterior, m)
    are_covered = have_pair(faces, g, h) .or. have_pair(faces, h, g)
  end function are_covered


  !> Whether two near faces of different bodies touch or would in an increment like the last one. Faces that passed each other in
  !! the last increment count, those on far sides do not.
  pure logical function may_meet(now, f, m, motion)
    type(exterior_type), intent(in) :: now
    integer, intent(in) :: f, m                    !< faces
    real(DP), intent(in) :: motion(3)              !< of f towards m in the last increment [length]
    real(DP) :: between(3), front, lateral, cosine, closing, depth, edge
    cosine = dot_product(now%normal(:, f), now%normal(:, m))
    edge = max(now%edge_length(f), now%edge_length(m))
    may_meet = box_distance(now%box(:, :, f), now%box(:, :, m)) <= TOUCHING_RADIUS * edge + norm2(motion) + max(0.0_DP, &
      now%height(f) + now%height(m))
    if (.not. may_meet .or. any(is_thin(now%depth([f, m]), now%edge_length([f, m])))) return
    between = now%centre(:, m) - now%centre(:, f)
    front = min(dot_product(between, now%normal(:, f)), -dot_product(between, now%normal(:, m))) - now%height(f) - now%height(m)
    lateral = norm2(between - dot_product(between, now%normal(:, f)) * now%normal(:, f))
    closing = max(0.0_DP, dot_product(motion, now%normal(:, f)), -dot_product(motion, now%normal(:, m)))
    depth = min(reached_depth(now%depth(f), now%thickness(f), now%edge_length(m)), reached_depth(now%depth(m), now%thickness(m), &
      now%edge_length(f)))
    may_meet = front <= TOUCHING_RADIUS * edge + closing .and. front + lateral * sqrt(max(0.0_DP, 1 - cosine**2)) >= &
      -MAX_DEPTH_SHARE * depth - closing
  end function may_meet


  !> The face on the other side of an element without depth.
  pure integer function other_side(exterior, f) result(other)
    type(exterior_type), intent(in) :: exterior
    integer, intent(in) :: f                       !< face
    do other = max(1, f - MAX_FACES), min(exterior%n, f + MAX_FACES)
      if (exterior%element(other) /= exterior%element(f)) cycle
      if (dot_product(exterior%normal(:, other), exterior%normal(:, f)) < -MIN_FACING_COSINE) return
    end do
    other = f
  end function other_side

end module amontons_unpaired_contact
