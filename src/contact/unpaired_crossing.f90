!> Crossing check: whether a body passed through a face of another one where contact is to keep them apart and does not act.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! General contact pairs faces that oppose each other near the start. The edge of a sheet, or a wedge, that is driven into a face
!! opposes nothing; a body may come from beyond the search. A pair by hand may have a narrow master between coarse slave nodes. What
!! all have in common: an edge of one body passes through a face of the other at the end of the increment, or the path of one of its
!! nodes does within the increment.
!!
!! Contact is to keep the face and a face around the edge apart: the rules of general contact say so, or a pair by hand that acts
!! has both. The crossing is *known*, and no fault, where contact acts: a face around the edge opposes the face that it passes
!! through, or one beside that behind which it lies by little more than the slave nodes, a pair has both, and a slave node there
!! touches: a body that is pressed in crosses the side faces at the border of its contact. So it is where an exclusion or a tie has
!! both, and of bodies that cross at the start or while their pair is removed.
!!
!! A pair by hand may have fewer faces than can meet, and chords of coarse curved surfaces cross where these do not. Its crossings
!! count from 0.14 of an edge on, and not at a node that touches.
!!
!! Two rigid bodies that supports drive have no pair in general contact, because no force moves them. A node of one passes through
!! the other where it comes behind a face, or an analytic surface, by the depth of a crossing since the last check. A sheet has both
!! sides: it is passed by a node that was clear of it before on the one side and is now on the other.
!!
!! Under NLGEOM an attempt with a crossing is repeated with a shorter increment, while that is longer than the crossing is deep.
!!
!! Cost: none while no node moved by a twentieth of an element; else linear in the faces that are within the boxes of other bodies.
module amontons_unpaired_crossing
  use amontons_kinds, only: DP
  use amontons_text, only: to_text
  use amontons_containers, only: integer_list_type
  use amontons_surfaces, only: contact_pair_type, general_contact_type, is_self_contact
  use amontons_model, only: model_type, absent_elements
  use amontons_facet_search, only: facet_search_type, find_near_facets
  use amontons_facet_crossing, only: plane_normal, cross_facet
  use amontons_exterior_surface, only: exterior_type, is_thin
  use amontons_state, only: slave_state_type, STATUS_OPEN
  use amontons_mortar_segmentation, only: MIN_FACING_COSINE, MIN_ROW_COSINE
  use amontons_body_motion, only: displacement_span
  use amontons_rigid_exterior, only: is_pair_driven, is_one_body
  use amontons_facets, only: facets_type
  use amontons_analytic_master, only: build_profile_facets, find_profile_projection, projection_type, PROJECTION_INSIDE
  use amontons_general_contact, only: find_interaction, are_named, body_name
  use amontons_exterior_membership, only: contact_rules
  use amontons_face_proximity, only: box_distance, find_active_faces, build_face_search, is_larger
  use amontons_unpaired_contact, only: model_faces_type, place_faces, smallest_width, have_pair, other_side, &
    is_new
  implicit none
  private
  public :: find_unpaired_crossing, least_crossing

  real(DP), parameter :: MIN_CROSSING = 0.05_DP            !< least depth of a crossing, over the smaller edge [-]
  real(DP), parameter :: MIN_PAIR_CROSSING = 0.14_DP       !< the same of a pair by hand: chords of 60 degrees are off by 0.13 [-]
  real(DP), parameter :: MIN_STEEPNESS = 0.25_DP           !< normal part of a path that crosses a face, over its length [-]
  real(DP), parameter :: MAX_BORDER_DEPTH = 0.25_DP        !< of a known crossing behind the face beside, over its edge [-]
  real(DP), parameter :: TOL_SIDE = 1.0e-4_DP              !< a node lies in a sheet up to this part of that depth [-]
  real(DP), parameter :: MAX_MEAN_DEPTH = 0.25_DP          !< of a crossing where a mortar pair is open, over the larger edge [-]

  !> Two faces, one of which the body of the other passed through.
  type :: crossing_type
    integer :: face(2) = 0                         !< of the body that passed through, and the face passed through; 0: none
    integer :: pair = 0                            !< by hand, which has both; 0: the rules of general contact
    integer :: surface = 0                         !< an analytic one in place of the face passed through
    logical :: is_driven = .false.                 !< supports prescribe the motion of both bodies
  end type crossing_type

  !> What the check looks at: the faces and what contact does between them at the end of an increment.
  type :: scene_type
    type(general_contact_type) :: rules
    real(DP), allocatable :: x(:, :), du(:, :)     !< (3, n_nodes) positions, and displacements of the last increment [length]
    real(DP) :: span = 0  !< bound of the motion of nodes relative to each other in it, and since the last check [length]
    real(DP), allocatable :: way(:, :)             !< (3, n_nodes) displacements since the last check [length]
    real(DP), allocatable :: clear_way(:, :)       !< (3, n_nodes) the same since no driven sheets were near each other [length]
    logical :: has_near_sheets = .false.           !< two driven sheets are nearer than the depth of a crossing
    logical, allocatable :: is_absent(:)           !< (n_elements) removed
    real(DP), allocatable :: penetration(:)        !< (n_nodes) of slave nodes that touch; negative: the node does not [length]
    logical, allocatable :: is_mortar(:)           !< (n_pairs) surface to surface
    logical, allocatable :: is_acting(:)           !< (n_pairs) not removed, and gaps are the distances of the faces
  end type scene_type

contains

  !> Whether bodies have passed through each other although contact is to keep them apart: message says which faces.
  subroutine find_unpaired_crossing(model, faces, slaves, u, du, step, message, is_driven)
    type(model_type), intent(in) :: model
    type(model_faces_type), intent(inout) :: faces !< prepared here if needed
    type(slave_state_type), intent(in) :: slaves(:)   !< of all pairs
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) of the last increment [length]
    integer, intent(in) :: step                    !< of the model, from 1
    character(:), allocatable, intent(out) :: message   !< '': none
    logical, intent(out), optional :: is_driven    !< supports prescribe the motion of both bodies
    type(scene_type) :: scene
    type(crossing_type) :: crossing
    real(DP) :: least
    message = ''
    if (present(is_driven)) is_driven = .false.
    if (.not. allocated(model%general_contact) .and. all(is_self_contact(model%pairs))) return
    if (.not. allocated(faces%checked_u)) faces%checked_u = 0 * u
    if (.not. allocated(faces%clear_u)) faces%clear_u = 0 * u
    least = least_crossing(model, faces)
    if (max(span(u - faces%checked_u), span(du)) < least) return
    call place_faces(model, faces, u, step)
    scene%rules = contact_rules(model)
    scene%is_mortar = model%pairs%is_mortar
    if (.not. allocated(faces%may_cross)) then
      allocate (faces%may_cross(faces%exterior%n_bodies, faces%exterior%n_bodies), source=.false.)
      scene%x = model%mesh%coordinates
      scene%du = 0 * du
      scene%way = 0 * du
      scene%clear_way = 0 * du
      scene%is_absent = absent_elements(model, 1)
      allocate (scene%penetration(model%mesh%n_nodes), source=-1.0_DP)
      allocate (scene%is_acting(size(model%pairs)), source=.true.)
      call permit_crossings(scene, faces, faces%exterior)
    end if
    scene%x = model%mesh%coordinates + u
    scene%du = du
    scene%way = u - faces%checked_u
    scene%span = max(displacement_span(model, du), displacement_span(model, scene%way))
    scene%clear_way = u - faces%clear_u
    scene%has_near_sheets = .false.
    scene%is_absent = absent_elements(model, step)
    scene%penetration = measure_penetrations(model, slaves)
    scene%is_acting = acting_pairs(model%pairs, slaves, least)
    if (allocated(model%steps(step)%is_removed)) scene%is_acting = scene%is_acting .and. .not. model%steps(step)%is_removed
    call find_crossing(scene, faces, faces%now, crossing)
    if (crossing%face(1) == 0) call find_profile_crossing(model, scene, faces, faces%now, crossing)
    if (crossing%face(1) > 0) then
      if (present(is_driven)) is_driven = crossing%is_driven
      call describe_crossing(model, faces%now, crossing, step, u, faces, message)
      return
    end if
    faces%checked_u = u
    if (.not. scene%has_near_sheets) faces%clear_u = u
    if (all(scene%is_acting)) return
    scene%is_acting = .not. scene%is_acting
    call permit_crossings(scene, faces, faces%now)

  contains

    !> A bound of the displacement of bodies relative to each other; an analytic one moves with nodes of no elements [length].
    real(DP) function span(u)
      real(DP), intent(in) :: u(:, :)              !< (3, n_nodes) [length]
      integer :: s
      span = displacement_span(model, u)
      do s = 1, size(model%surfaces)
        if (.not. allocated(model%surfaces(s)%profile)) cycle
        span = max(span, norm2(maxval(abs(u), dim=2)) + maxval(norm2(u(:, model%surfaces(s)%nodes), dim=1)))
      end do
    end function span

  end subroutine find_unpaired_crossing


  !> The least depth of a crossing in the model [length].
  real(DP) function least_crossing(model, faces) result(least)
    type(model_type), intent(in) :: model
    type(model_faces_type), intent(inout) :: faces !< its least_width
    if (faces%least_width < 0.0_DP) faces%least_width = smallest_width(model)
    least = MIN_CROSSING * faces%least_width
  end function least_crossing


  !> How deep the slave nodes that touch lie behind the faces of their masters; where contact acts at points of faces, any depth.
  pure function measure_penetrations(model, slaves) result(penetration)
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: slaves(:)
    real(DP) :: penetration(model%mesh%n_nodes)    !< negative: the node does not touch [length]
    integer :: p, s
    penetration = -1.0_DP
    do s = 1, size(slaves)
      if (slaves(s)%status == STATUS_OPEN .or. slaves(s)%slave_facet > 0) cycle
      penetration(slaves(s)%node) = max(0.0_DP, penetration(slaves(s)%node), slaves(s)%offset - slaves(s)%gap)
    end do
    do p = 1, size(model%pairs)
      if (model%pairs(p)%has_point_contact) penetration(model%surfaces(model%pairs(p)%slave)%nodes) = huge(1.0_DP)
    end do
  end function measure_penetrations


  !> The pairs whose gaps are the distances of the faces: no clearance or interference lets a slave go behind its master.
  pure function acting_pairs(pairs, slaves, least) result(is_acting)
    type(contact_pair_type), intent(in) :: pairs(:)
    type(slave_state_type), intent(in) :: slaves(:)
    real(DP), intent(in) :: least                  !< a smaller offset does not count [length]
    logical :: is_acting(size(pairs))
    is_acting = .not. (pairs%has_clearance .and. pairs%clearance > least)
    is_acting(pack(slaves%pair, slaves%offset > least)) = .false.
  end function acting_pairs


  !> Bodies that cross now may do so from now on.
  subroutine permit_crossings(scene, faces, now)
    type(scene_type), intent(inout) :: scene
    type(model_faces_type), intent(inout) :: faces !< its may_cross
    type(exterior_type), intent(in) :: now         !< measured at x
    type(crossing_type) :: crossing
    do
      call find_crossing(scene, faces, now, crossing)
      if (crossing%face(1) == 0) exit
      associate (bodies => now%body(crossing%face))
        faces%may_cross(bodies, bodies) = .true.
      end associate
    end do
  end subroutine permit_crossings


  !> Finds the first crossing of bodies that may not cross.
  subroutine find_crossing(scene, faces, now, crossing)
    type(scene_type), intent(inout) :: scene
    type(model_faces_type), intent(in) :: faces
    type(exterior_type), intent(in) :: now         !< measured at x
    type(crossing_type), intent(out) :: crossing
    type(facet_search_type) :: search
    logical, allocatable :: is_active(:)
    integer, allocatable :: active(:), list(:)
    integer :: i, k, n, f, m
    call find_active_faces(now, scene%span + MIN_CROSSING * maxval(now%edge_length), is_active)
    active = pack([(f, f=1, now%n)], is_active)
    if (size(active) == 0) return
    call build_face_search(now, active, MIN_CROSSING, scene%span, search)
    do i = 1, size(active)
      f = active(i)
      call find_near_facets(search, now%centre(:, f), list, n)
      do k = 1, n
        m = active(list(k))
        if (.not. may_be_crossed(scene, faces, now, f, m)) cycle
        call cross_face(scene, faces, now, f, m, crossing)
        if (crossing%face(1) == 0) call cross_face(scene, faces, now, m, f, crossing)
        if (crossing%face(1) == 0) cycle
        crossing%is_driven = are_driven(faces, now, [f, m])
        return
      end do
    end do
  end subroutine find_crossing


  !> Whether two faces belong to rigid bodies that supports drive.
  pure logical function are_driven(faces, now, both)
    type(model_faces_type), intent(in) :: faces
    type(exterior_type), intent(in) :: now
    integer, intent(in) :: both(2)                 !< faces
    are_driven = all(faces%data%is_rigid(both))
    if (are_driven) are_driven = is_pair_driven(faces%data%rigid, now%nodes(now%first(both)))
  end function are_driven


  !> Finds the first corner of a driven rigid body that came behind a driven analytic surface since the last check, although the
  !! rules of general contact keep both apart.
  subroutine find_profile_crossing(model, scene, faces, now, crossing)
    type(model_type), intent(in) :: model
    type(scene_type), intent(in) :: scene
    type(model_faces_type), intent(in) :: faces
    type(exterior_type), intent(in) :: now         !< measured at x
    type(crossing_type), intent(out) :: crossing
    type(facets_type) :: facets
    integer :: s, f, k
    do s = 1, size(model%surfaces)
      if (.not. allocated(model%surfaces(s)%profile)) cycle
      if (.not. faces%data%rigid%is_driven(model%surfaces(s)%nodes(1))) cycle
      do f = 1, now%n
        if (.not. faces%data%is_rigid(f) .or. scene%is_absent(now%element(f))) cycle
        associate (nodes => [now%nodes(now%first(f)), model%surfaces(s)%nodes(1)])
          if (.not. is_pair_driven(faces%data%rigid, nodes) .or. is_one_body(faces%data%rigid, nodes)) cycle
        end associate
        if (find_interaction(scene%rules, faces%data, faces%data%group(f), 0, s) == 0) cycle
        call build_profile_facets(model%surfaces(s)%profile, now%edge_length(f), facets)
        do k = now%first(f), now%first(f) + now%n_corners(f) - 1
          if (.not. comes_behind(now%nodes(k), MIN_CROSSING * now%edge_length(f))) cycle
          crossing = crossing_type(face=[f, 0], surface=s, is_driven=.true.)
          return
        end do
      end do
    end do

  contains

    !> Whether a node was before the surface at the last check, to a tolerance, and is behind it now.
    pure logical function comes_behind(node, tolerance)
      integer, intent(in) :: node
      real(DP), intent(in) :: tolerance            !< [length]
      comes_behind = gap_of(scene%x, node) < -tolerance
      if (comes_behind) comes_behind = gap_of(scene%x - scene%way, node) >= -tolerance
    end function comes_behind

    !> The gap of a node; huge beside the surface [length].
    pure real(DP) function gap_of(x, node) result(gap)
      real(DP), intent(in) :: x(:, :)              !< (3, n_nodes) [length]
      integer, intent(in) :: node
      type(projection_type) :: projection
      call find_profile_projection(facets, x, x(:, node), huge(1.0_DP), projection)
      gap = huge(1.0_DP)
      if (projection%status == PROJECTION_INSIDE) gap = projection%gap
    end function gap_of

  end subroutine find_profile_crossing


  !> Whether two faces are near each other, those of bodies that may not cross; the second one is the larger. Those whose surfaces
  !! in contact lie below them may cross.
  pure logical function may_be_crossed(scene, faces, now, f, m) result(may_be)
    type(scene_type), intent(in) :: scene
    type(model_faces_type), intent(in) :: faces
    type(exterior_type), intent(in) :: now
    integer, intent(in) :: f, m                    !< faces
    may_be = .false.
    if (now%body(f) == now%body(m) .or. .not. is_larger(now, m, f)) return
    if (any(scene%is_absent(now%element([f, m])))) return
    if (faces%may_cross(now%body(f), now%body(m)) .or. now%height(f) + now%height(m) < 0.0_DP) return
    if (box_distance(now%box(:, :, f), now%box(:, :, m)) > scene%span + merge(MIN_CROSSING * now%edge_length(f), 0.0_DP, &
      are_driven(faces, now, [f, m]))) return
    may_be = .true.
    if (faces%data%is_rigid(f) .and. faces%data%is_rigid(m)) may_be = .not. is_one_body(faces%data%rigid, &
      now%nodes(now%first([f, m])))
  end function may_be_crossed


  !> Whether an edge of a face, or the path of a corner, passes through another face although contact is to keep them apart.
  subroutine cross_face(scene, faces, now, f, m, crossing)
    type(scene_type), intent(inout) :: scene
    type(model_faces_type), intent(in) :: faces
    type(exterior_type), intent(in) :: now
    integer, intent(in) :: f                       !< face whose edges and corners are looked at
    integer, intent(in) :: m                       !< face that they may pass through
    type(crossing_type), intent(inout) :: crossing !< set where they do
    integer :: k, n, ends(2)
    real(DP) :: corner(3, 4), point(3), motion(3), least, depth
    logical :: is_crossed, is_driven, is_sheet
    least = MIN_CROSSING * min(now%edge_length(f), now%edge_length(m))
    is_driven = are_driven(faces, now, [f, m])
    is_sheet = is_driven .and. is_thin(now%depth(m), now%edge_length(m))
    associate (own => now%nodes(now%first(f):now%first(f) + now%n_corners(f) - 1), &
      nodes => now%nodes(now%first(m):now%first(m) + now%n_corners(m) - 1), x => scene%x, du => scene%du)
      n = size(nodes)
      corner(:, :n) = x(:, nodes)
      motion = sum(du(:, nodes), dim=2) / real(n, DP)
      do k = 1, size(own)
        ends = [own(k), own(modulo(k, size(own)) + 1)]
        call cross_facet(corner(:, :n), x(:, ends), is_crossed, point)
        if (is_crossed) then
          depth = min(depth_through(faces, now, m, ends, x), depth_through(faces, now, f, nodes, x))
          if (depth >= least) call judge_crossing(scene, faces, now, ends, [f, m], point, depth, crossing)
        end if
        if (crossing%face(1) == 0) then
          depth = dot_product(now%normal(:, m), now%centre(:, m) - x(:, own(k)))
          if (is_sheet) then
            if (abs(depth) < least) scene%has_near_sheets = .true.
            motion = sum(scene%clear_way(:, nodes), dim=2) / real(n, DP)
            call cross_on_path(corner(:, :n), x(:, own(k)), scene%clear_way(:, own(k)) - motion, least, TOL_SIDE * least, &
              is_crossed, point)
          else if (is_driven) then
            motion = sum(scene%way(:, nodes), dim=2) / real(n, DP)
            call cross_on_path(corner(:, :n), x(:, own(k)), scene%way(:, own(k)) - motion, least, -least, is_crossed, point)
          else
            call cross_on_path(corner(:, :n), x(:, own(k)), du(:, own(k)) - motion, least, least, is_crossed, point)
          end if
          if (is_crossed) call judge_crossing(scene, faces, now, [own(k), own(k)], [f, m], point, depth, crossing)
        end if
        if (crossing%face(1) > 0) return
      end do
    end associate
  end subroutine cross_face


  !> Takes a crossing of an edge in, if contact is to keep the face and one around the edge apart, and does not act there.
  subroutine judge_crossing(scene, faces, now, ends, crossed, point, depth, crossing)
    type(scene_type), intent(in) :: scene
    type(model_faces_type), intent(in) :: faces
    type(exterior_type), intent(in) :: now
    integer, intent(in) :: ends(2)                 !< nodes of the edge
    integer, intent(in) :: crossed(2)              !< face with the edge, and the face that it passes through
    real(DP), intent(in) :: point(3)               !< of the crossing [length]
    real(DP), intent(in) :: depth                  !< [length]
    type(crossing_type), intent(inout) :: crossing
    type(integer_list_type) :: around, beside
    real(DP) :: border                             ! depth to which the sides beside a contact may be crossed [length]
    logical :: is_free, is_touching
    integer :: i, j, pair
    is_touching = any(scene%penetration([ends, now%nodes(now%first(crossed(2)):now%first(crossed(2) + 1) - 1)]) >= 0.0_DP)
    call list_around(faces, ends, around)
    call list_beside(faces, now, crossed(2), beside)
    do i = 1, around%n
      do j = 1, beside%n
        associate (g => around%items(i), h => beside%items(j))
          border = MAX_BORDER_DEPTH * now%edge_length(h) + max(0.0_DP, largest_penetration(scene, now, g, h))
          if (j > 2 .and. abs(dot_product(now%normal(:, h), point - now%centre(:, h))) > border) cycle
          call find_rule(scene, faces, g, h, is_free, pair)
          if (is_free .or. (is_touching .and. pair > 0) .or. acts_between(scene, faces, now, g, h, pair, depth)) then
            crossing = crossing_type()
            return
          end if
          if (pair > 0 .and. depth < MIN_PAIR_CROSSING * minval(now%edge_length(crossed))) cycle
          if (j <= 2 .and. pair >= 0) crossing = crossing_type(crossed, pair)
        end associate
      end do
    end do
  end subroutine judge_crossing


  !> What the deck says of two faces: the pair by hand that has both and acts; else whether an exclusion, a tie or a pair that does
  !! not act leaves them out; else the rules of general contact.
  pure subroutine find_rule(scene, faces, g, h, is_free, pair)
    type(scene_type), intent(in) :: scene
    type(model_faces_type), intent(in) :: faces
    integer, intent(in) :: g, h                    !< faces
    logical, intent(out) :: is_free                !< they may pass each other
    integer, intent(out) :: pair                   !< by hand; 0: general contact keeps them apart; -1: nothing does
    integer :: k, given
    is_free = .false.
    pair = -1
    associate (data => faces%data)
      do k = 1, size(data%excluded, 2)
        if (.not. are_named(data, data%group(g), data%group(h), data%excluded(:, k), 0)) cycle
        given = data%given_pair(k)
        is_free = .true.
        if (given > 0) is_free = .not. scene%is_acting(given)
        if (.not. is_free) pair = given
        if (.not. is_free) return
      end do
      if (is_free) return
      if (find_interaction(scene%rules, data, data%group(g), data%group(h), 0) > 0) pair = 0
    end associate
  end subroutine find_rule


  !> Whether the path of a node crosses a face from front to back, steeply, and ends at some distance from it.
  pure subroutine cross_on_path(corner, x, path, least, first, is_crossed, point)
    real(DP), intent(in) :: corner(:, :)           !< (3, :) of the face [length]
    real(DP), intent(in) :: x(3), path(3)          !< end of the path, and the path relative to the face [length]
    real(DP), intent(in) :: least                  !< depth of its end behind the plane of the face [length]
    real(DP), intent(in) :: first                  !< least height of its start; negative: the path begins before that [length]
    logical, intent(out) :: is_crossed
    real(DP), intent(out) :: point(3)              !< [length]
    real(DP) :: height, rise, reached
    associate (normal => plane_normal(corner, size(corner, 2) == 2))
      height = dot_product(normal, x - sum(corner, dim=2) / real(size(corner, 2), DP))
      rise = dot_product(normal, path)
    end associate
    point = x
    is_crossed = height < -least .and. height - rise > first .and. -rise >= MIN_STEEPNESS * norm2(path)
    if (.not. is_crossed) return
    reached = 1.0_DP
    if (first < 0.0_DP) reached = 1.0_DP + 2 * least / (-rise)
    call cross_facet(corner, reshape([x - reached * path, x], [3, 2]), is_crossed, point)
  end subroutine cross_on_path


  !> The distance by which the faces around some nodes reach to both sides of the plane of a face, on the side where it is less
  !! [length]: how deep the surface with these nodes went through the face.
  pure real(DP) function depth_through(faces, now, f, nodes, x) result(depth)
    type(model_faces_type), intent(in) :: faces
    type(exterior_type), intent(in) :: now
    integer, intent(in) :: f                       !< face
    integer, intent(in) :: nodes(:)
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    real(DP) :: low, high, height
    integer :: i, j, k
    low = 0.0_DP
    high = 0.0_DP
    do k = 1, size(nodes)
      do i = faces%node_first(nodes(k)), faces%node_first(nodes(k) + 1) - 1
        associate (g => faces%node_face(i))
          do j = now%first(g), now%first(g) + now%n_corners(g) - 1
            height = dot_product(now%normal(:, f), x(:, now%nodes(j)) - now%centre(:, f))
            low = min(low, height)
            high = max(high, height)
          end do
        end associate
      end do
    end do
    depth = min(-low, high)
  end function depth_through


  !> The faces around the ends of an edge.
  subroutine list_around(faces, ends, around)
    type(model_faces_type), intent(in) :: faces
    integer, intent(in) :: ends(2)                 !< nodes
    type(integer_list_type), intent(out) :: around
    integer :: i, k
    do k = 1, merge(2, 1, ends(2) /= ends(1))
      do i = faces%node_first(ends(k)), faces%node_first(ends(k) + 1) - 1
        call around%add(faces%node_face(i))
      end do
    end do
  end subroutine list_around


  !> The face itself, its other side, and the faces that share a corner with it.
  subroutine list_beside(faces, now, m, beside)
    type(model_faces_type), intent(in) :: faces
    type(exterior_type), intent(in) :: now
    integer, intent(in) :: m                       !< face
    type(integer_list_type), intent(out) :: beside
    integer :: i, k
    call beside%add(m)
    call beside%add(merge(other_side(now, m), m, is_thin(now%depth(m), now%edge_length(m))))
    do k = now%first(m), now%first(m) + now%n_corners(m) - 1
      do i = faces%node_first(now%nodes(k)), faces%node_first(now%nodes(k) + 1) - 1
        call beside%add(faces%node_face(i))
      end do
    end do
  end subroutine list_beside


  !> Whether contact acts between two faces that oppose each other: a pair has them, or the other side of one without depth, and
  !! slave nodes of one touch, or a mortar pair, which holds in the mean, is open by little.
  pure logical function acts_between(scene, faces, now, g, h, pair, depth) result(acts)
    type(scene_type), intent(in) :: scene
    type(model_faces_type), intent(in) :: faces
    type(exterior_type), intent(in) :: now
    integer, intent(in) :: g, h                    !< faces
    integer, intent(in) :: pair                    !< by hand, which has both; else 0 or less
    real(DP), intent(in) :: depth                  !< of the crossing [length]
    logical :: is_mortar
    integer :: other
    real(DP) :: cosine
    acts = .false.
    cosine = dot_product(now%normal(:, g), now%normal(:, h))
    other = g
    if (cosine > 0.0_DP .and. is_thin(now%depth(g), now%edge_length(g))) other = other_side(now, g)
    is_mortar = scene%rules%is_mortar
    if (pair > 0) is_mortar = scene%is_mortar(pair)
    if ((other == g .and. cosine > 0.0_DP) .or. abs(cosine) < merge(MIN_ROW_COSINE, MIN_FACING_COSINE, is_mortar)) return
    acts = (is_mortar .and. depth <= MAX_MEAN_DEPTH * max(now%edge_length(g), now%edge_length(h))) .or. &
      largest_penetration(scene, now, g, h) >= 0.0_DP
    if (acts .and. pair <= 0) acts = have_pair(faces, other, h) .or. have_pair(faces, h, other)
  end function acts_between


  !> The largest penetration of the slave nodes of two faces that touch; negative: none touches [length].
  pure real(DP) function largest_penetration(scene, now, g, h) result(largest)
    type(scene_type), intent(in) :: scene
    type(exterior_type), intent(in) :: now
    integer, intent(in) :: g, h                    !< faces
    largest = max(maxval(scene%penetration(now%nodes(now%first(g):now%first(g + 1) - 1))), &
      maxval(scene%penetration(now%nodes(now%first(h):now%first(h + 1) - 1))))
  end function largest_penetration


  !> The sentence about a crossing, with what helps.
  subroutine describe_crossing(model, now, crossing, step, u, faces, message)
    type(model_type), intent(in) :: model
    type(exterior_type), intent(in) :: now
    type(crossing_type), intent(in) :: crossing
    integer, intent(in) :: step                    !< of the model, from 1
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    type(model_faces_type), intent(in) :: faces
    character(:), allocatable, intent(out) :: message
    character(:), allocatable :: pair, kind
    logical :: is_mortar
    pair = 'General contact'
    kind = '*CONTACT'
    if (crossing%pair > 0) then
      pair = 'Contact pair ' // model%pairs(crossing%pair)%name
      kind = '*CONTACT PAIR'
      is_mortar = model%pairs(crossing%pair)%is_mortar
    else
      is_mortar = model%general_contact%is_mortar
    end if
    if (crossing%surface > 0) then
      message = model%surfaces(crossing%surface)%name
    else
      message = 'element ' // side_text(crossing%face(2))
    end if
    message = pair // ': element ' // side_text(crossing%face(1)) // ' passed through ' // message // ', and no contact keeps ' // &
      'them apart there. '
    if (crossing%is_driven) then
      message = message // 'Supports prescribe the motion of both rigid bodies: leave one free where it touches, on a spring.'
    else if (is_new(faces, crossing%face(1)) .or. is_new(faces, crossing%face(2))) then
      message = message // 'Faces that *MODEL CHANGE uncovered or added have no pair: name it with *CONTACT PAIR.'
    else if (.not. model%steps(step)%is_nlgeom .and. displacement_span(model, u) > faces%least_width) then
      message = message // 'Without NLGEOM bodies touch only where they are near each other at the start: give NLGEOM on *STEP.'
    else if (any(is_thin(now%depth(crossing%face), now%edge_length(crossing%face)))) then
      message = message // 'The edge of a sheet of rigid elements touches nothing: make that body of solid elements with ' // &
        '*RIGID BODY, which have a depth.'
    else if (.not. is_mortar) then
      message = message // 'Slave nodes touch what lies below them, not what lies between them: ' // kind // &
        ', TYPE=SURFACE TO SURFACE looks at their faces.'
    else if (crossing%pair > 0) then
      message = message // 'Its surfaces must have all faces that can touch.'
    else
      message = message // 'Faces inclined by more than 60 degrees do not touch in the mean: *CONTACT, TYPE=NODE TO SURFACE ' // &
        'touches with corners and edges.'
    end if
    if (crossing%pair > 0) then
      message = message // ' Bodies that may pass each other need no *CONTACT PAIR; *MODEL CHANGE removes it for a step.'
    else
      message = message // ' Bodies that may pass each other are named in *CONTACT EXCLUSIONS.'
    end if

  contains

    !> A face in words.
    function side_text(f) result(text)
      integer, intent(in) :: f                     !< face
      character(:), allocatable :: text
      text = to_text(model%mesh%element_label(now%element(f))) // ' of ' // body_name(model, now, now%body(f))
    end function side_text

  end subroutine describe_crossing

end module amontons_unpaired_crossing
