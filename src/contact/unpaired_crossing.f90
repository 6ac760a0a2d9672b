!> Crossing check of general contact: whether a body passed through a face of another one where no pair keeps them apart.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Pairs have faces that oppose each other near the start. The edge of a sheet, or a wedge, that is driven into a face opposes
!! nothing; a body may come from beyond the search. What both have in common: an edge of one body passes through a face of the
!! other at the end of the increment, or the path of one of its nodes does within the increment.
!!
!! A crossing is *known*, and no fault, where a face around the edge opposes the face that it passes through, or one beside that
!! behind which it lies by little, a pair has both, and a slave node there touches: a body that is pressed in by little crosses the
!! side faces at the border of its contact. So it is where an exclusion or a tie has both, and of bodies that cross at the start.
!!
!! Cost: none while no node moved by a twentieth of an element; else linear in the faces that are within the boxes of other bodies.
module amontons_unpaired_crossing
  use amontons_kinds, only: DP
  use amontons_text, only: to_text
  use amontons_containers, only: integer_list_type
  use amontons_surfaces, only: general_contact_type
  use amontons_model, only: model_type, absent_elements
  use amontons_facet_search, only: facet_search_type, find_near_facets
  use amontons_facet_crossing, only: plane_normal, cross_facet
  use amontons_exterior_surface, only: exterior_type, measure_faces, is_thin
  use amontons_state, only: slave_state_type, STATUS_OPEN
  use amontons_mortar_segmentation, only: MIN_FACING_COSINE
  use amontons_body_motion, only: displacement_span
  use amontons_rigid_exterior, only: is_pair_driven
  use amontons_general_contact, only: find_interaction, body_name
  use amontons_face_proximity, only: box_distance, find_active_faces, build_face_search, is_larger
  use amontons_unpaired_contact, only: model_faces_type, prepare_faces, smallest_width, have_pair, other_side
  implicit none
  private
  public :: find_unpaired_crossing

  real(DP), parameter :: MIN_CROSSING = 0.05_DP            !< least depth of a crossing, over the smaller edge [-]
  real(DP), parameter :: MIN_STEEPNESS = 0.25_DP           !< normal part of a path that crosses a face, over its length [-]
  real(DP), parameter :: MAX_BORDER_DEPTH = 0.25_DP        !< of a known crossing behind the face beside, over its edge [-]
  real(DP), parameter :: MAX_MEAN_DEPTH = 0.25_DP          !< of a crossing where a mortar pair is open, over the larger edge [-]

  !> Two faces, one of which the body of the other passed through.
  type :: crossing_type
    integer :: face(2) = 0                         !< of the body that passed through, and the face passed through; 0: none
  end type crossing_type

contains

  !> Whether bodies have passed through each other without a pair: message says which faces.
  subroutine find_unpaired_crossing(model, faces, slaves, u, du, step, message)
    type(model_type), intent(in) :: model
    type(model_faces_type), intent(inout) :: faces !< prepared here if needed
    type(slave_state_type), intent(in) :: slaves(:)   !< of all pairs
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) of the last increment [length]
    integer, intent(in) :: step                    !< of the model, from 1
    character(:), allocatable, intent(out) :: message   !< '': none
    type(exterior_type) :: now
    type(crossing_type) :: crossing
    real(DP) :: least
    message = ''
    if (.not. allocated(model%general_contact)) return
    if (faces%least_width < 0.0_DP) faces%least_width = smallest_width(model)
    least = MIN_CROSSING * faces%least_width
    if (.not. allocated(faces%checked_u)) faces%checked_u = 0 * u
    if (max(displacement_span(model, u - faces%checked_u), displacement_span(model, du)) < least) return
    faces%checked_u = u
    call prepare_faces(model, faces)
    if (faces%exterior%n_bodies < 2) return
    now = faces%exterior
    if (.not. allocated(faces%may_cross)) then
      allocate (faces%may_cross(now%n_bodies, now%n_bodies), source=.false.)
      allocate (faces%is_touching(model%mesh%n_nodes), source=.false.)
      faces%is_absent = absent_elements(model, 1)
      do
        call find_crossing(model%general_contact, faces, now, model%mesh%coordinates, 0 * du, 0.0_DP, crossing)
        if (crossing%face(1) == 0) exit
        associate (bodies => now%body(crossing%face))
          faces%may_cross(bodies, bodies) = .true.
        end associate
      end do
    end if
    faces%is_touching = touching_nodes(model, slaves)
    faces%is_absent = absent_elements(model, step)
    call measure_faces(model%mesh, model%mesh%coordinates + u, now)
    call find_crossing(model%general_contact, faces, now, model%mesh%coordinates + u, du, displacement_span(model, du), crossing)
    if (crossing%face(1) > 0) call describe_crossing(model, now, crossing, model%steps(step)%is_nlgeom, u, faces, message)
  end subroutine find_unpaired_crossing


  !> The slave nodes that touch their masters; where contact acts at points of faces, all nodes.
  pure function touching_nodes(model, slaves) result(is_touching)
    type(model_type), intent(in) :: model
    type(slave_state_type), intent(in) :: slaves(:)
    logical :: is_touching(model%mesh%n_nodes)
    integer :: p
    is_touching = .false.
    is_touching(pack(slaves%node, slaves%status /= STATUS_OPEN .and. slaves%slave_facet == 0)) = .true.
    do p = 1, size(model%pairs)
      if (model%pairs(p)%has_point_contact) is_touching(model%surfaces(model%pairs(p)%slave)%nodes) = .true.
    end do
  end function touching_nodes


  !> Finds the first crossing of bodies that may not cross.
  subroutine find_crossing(rules, faces, now, x, du, span, crossing)
    type(general_contact_type), intent(in) :: rules
    type(model_faces_type), intent(in) :: faces
    type(exterior_type), intent(in) :: now         !< measured at x
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    real(DP), intent(in) :: du(:, :)               !< (3, n_nodes) of the last increment [length]
    real(DP), intent(in) :: span                   !< bound of the motion of nodes relative to each other in it [length]
    type(crossing_type), intent(out) :: crossing
    type(facet_search_type) :: search
    logical, allocatable :: is_active(:)
    integer, allocatable :: active(:), list(:)
    integer :: i, k, n, f, m
    call find_active_faces(now, span, is_active)
    active = pack([(f, f=1, now%n)], is_active)
    if (size(active) == 0) return
    call build_face_search(now, active, 0.0_DP, span, search)
    do i = 1, size(active)
      f = active(i)
      call find_near_facets(search, now%centre(:, f), list, n)
      do k = 1, n
        m = active(list(k))
        if (.not. may_be_crossed(rules, faces, now, f, m, span)) cycle
        if (has_crossed(rules, faces, now, f, m, x, du)) crossing%face = [f, m]
        if (crossing%face(1) > 0) return
        if (has_crossed(rules, faces, now, m, f, x, du)) crossing%face = [m, f]
        if (crossing%face(1) > 0) return
      end do
    end do
  end subroutine find_crossing


  !> Whether two faces are near each other, those of bodies that general contact keeps apart; the second one is the larger. Those
  !! whose surfaces in contact lie below them may cross.
  pure logical function may_be_crossed(rules, faces, now, f, m, span) result(may_be)
    type(general_contact_type), intent(in) :: rules
    type(model_faces_type), intent(in) :: faces
    type(exterior_type), intent(in) :: now
    integer, intent(in) :: f, m                    !< faces
    real(DP), intent(in) :: span                   !< [length]
    may_be = .false.
    if (now%body(f) == now%body(m) .or. .not. is_larger(now, m, f)) return
    if (any(faces%is_absent(now%element([f, m])))) return
    if (faces%may_cross(now%body(f), now%body(m)) .or. now%height(f) + now%height(m) < 0.0_DP) return
    if (box_distance(now%box(:, :, f), now%box(:, :, m)) > span) return
    if (faces%data%is_rigid(f) .and. faces%data%is_rigid(m)) then
      if (is_pair_driven(faces%data%rigid, now%nodes(now%first([f, m])))) return
    end if
    may_be = .not. are_excluded(rules, faces, f, m)
  end function may_be_crossed


  !> Whether the rules of general contact, a pair by hand or a tie leave two faces out.
  pure logical function are_excluded(rules, faces, f, m)
    type(general_contact_type), intent(in) :: rules
    type(model_faces_type), intent(in) :: faces
    integer, intent(in) :: f, m                    !< faces
    are_excluded = find_interaction(rules, faces%data, faces%data%group(f), faces%data%group(m), 0) == 0
  end function are_excluded


  !> Whether an edge of a face, or the path of a corner, passes through another face, and no pair knows of it.
  logical function has_crossed(rules, faces, now, f, m, x, du)
    type(general_contact_type), intent(in) :: rules
    type(model_faces_type), intent(in) :: faces
    type(exterior_type), intent(in) :: now
    integer, intent(in) :: f                       !< face whose edges and corners are looked at
    integer, intent(in) :: m                       !< face that they may pass through
    real(DP), intent(in) :: x(:, :), du(:, :)      !< (3, n_nodes) [length]
    integer :: k, n, ends(2)
    real(DP) :: corner(3, 4), point(3), motion(3), least, depth
    real(DP) :: mean_depth                         ! at which a mortar pair may be open [length]
    logical :: is_crossed
    least = MIN_CROSSING * min(now%edge_length(f), now%edge_length(m))
    mean_depth = -huge(1.0_DP)
    if (rules%is_mortar) mean_depth = MAX_MEAN_DEPTH * max(now%edge_length(f), now%edge_length(m))
    associate (own => now%nodes(now%first(f):now%first(f) + now%n_corners(f) - 1), &
      nodes => now%nodes(now%first(m):now%first(m) + now%n_corners(m) - 1))
      n = size(nodes)
      corner(:, :n) = x(:, nodes)
      motion = sum(du(:, nodes), dim=2) / real(n, DP)
      has_crossed = .true.
      do k = 1, size(own)
        ends = [own(k), own(modulo(k, size(own)) + 1)]
        call cross_facet(corner(:, :n), x(:, ends), is_crossed, point)
        if (is_crossed) then
          depth = min(depth_through(faces, now, m, ends, x), depth_through(faces, now, f, nodes, x))
          is_crossed = depth >= least
        end if
        if (is_crossed) is_crossed = .not. is_known(rules, faces, now, ends, m, point, depth <= mean_depth)
        if (is_crossed) return
        if (norm2(du(:, own(k)) - motion) < least) cycle
        call cross_on_path(corner(:, :n), x(:, own(k)), du(:, own(k)) - motion, least, is_crossed, point)
        depth = dot_product(now%normal(:, m), now%centre(:, m) - x(:, own(k)))
        if (is_crossed) is_crossed = .not. is_known(rules, faces, now, [own(k), own(k)], m, point, depth <= mean_depth)
        if (is_crossed) return
      end do
      has_crossed = .false.
    end associate
  end function has_crossed


  !> Whether the path of a node crosses a face from front to back, steeply, and starts and ends at some distance from it.
  pure subroutine cross_on_path(corner, x, path, least, is_crossed, point)
    real(DP), intent(in) :: corner(:, :)           !< (3, :) of the face [length]
    real(DP), intent(in) :: x(3), path(3)          !< end of the path, and the path relative to the face [length]
    real(DP), intent(in) :: least                  !< distance of both ends from the plane of the face [length]
    logical, intent(out) :: is_crossed
    real(DP), intent(out) :: point(3)              !< [length]
    real(DP) :: height, rise
    associate (normal => plane_normal(corner, size(corner, 2) == 2))
      height = dot_product(normal, x - sum(corner, dim=2) / real(size(corner, 2), DP))
      rise = dot_product(normal, path)
    end associate
    point = x
    is_crossed = height < -least .and. height - rise > least .and. -rise >= MIN_STEEPNESS * norm2(path)
    if (is_crossed) call cross_facet(corner, reshape([x - path, x], [3, 2]), is_crossed, point)
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


  !> Whether a pair, an exclusion or a tie of a face around the ends of an edge has the crossed face, or one beside it behind which
  !! the crossing lies by little.
  logical function is_known(rules, faces, now, ends, m, point, may_be_open)
    type(general_contact_type), intent(in) :: rules
    type(model_faces_type), intent(in) :: faces
    type(exterior_type), intent(in) :: now
    integer, intent(in) :: ends(2)                 !< nodes of the edge
    integer, intent(in) :: m                       !< crossed face
    real(DP), intent(in) :: point(3)               !< of the crossing [length]
    logical, intent(in) :: may_be_open             !< no slave node need touch there: mortar contact holds in the mean
    type(integer_list_type) :: beside
    integer :: i, j, k
    is_known = .true.
    call list_beside(faces, now, m, beside)
    do k = 1, 2
      do i = faces%node_first(ends(k)), faces%node_first(ends(k) + 1) - 1
        do j = 1, beside%n
          associate (g => faces%node_face(i), h => beside%items(j))
            if (j > 2 .and. abs(dot_product(now%normal(:, h), point - now%centre(:, h))) &
              > MAX_BORDER_DEPTH * now%edge_length(h)) cycle
            if (are_known(rules, faces, now, g, h, may_be_open)) return
          end associate
        end do
      end do
    end do
    is_known = .false.
  end function is_known


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
  !! slave nodes of one touch; or whether they are left out.
  pure logical function are_known(rules, faces, now, g, h, may_be_open)
    type(general_contact_type), intent(in) :: rules
    type(model_faces_type), intent(in) :: faces
    type(exterior_type), intent(in) :: now
    integer, intent(in) :: g, h                    !< faces
    logical, intent(in) :: may_be_open
    integer :: other, k
    real(DP) :: cosine
    are_known = are_excluded(rules, faces, g, h)
    cosine = dot_product(now%normal(:, g), now%normal(:, h))
    other = g
    if (cosine > 0.0_DP .and. is_thin(now%depth(g), now%edge_length(g))) other = other_side(now, g)
    if (are_known .or. (other == g .and. cosine > 0.0_DP) .or. abs(cosine) < MIN_FACING_COSINE) return
    are_known = may_be_open
    do k = 1, 2
      associate (face => merge(g, h, k == 1))
        are_known = are_known .or. any(faces%is_touching(now%nodes(now%first(face):now%first(face + 1) - 1)))
      end associate
    end do
    if (are_known) are_known = have_pair(faces, other, h) .or. have_pair(faces, h, other)
  end function are_known


  !> The sentence about a crossing, with what helps.
  subroutine describe_crossing(model, now, crossing, is_nlgeom, u, faces, message)
    type(model_type), intent(in) :: model
    type(exterior_type), intent(in) :: now
    type(crossing_type), intent(in) :: crossing
    logical, intent(in) :: is_nlgeom
    real(DP), intent(in) :: u(:, :)                !< (3, n_nodes) [length]
    type(model_faces_type), intent(in) :: faces
    character(:), allocatable, intent(out) :: message
    message = 'General contact: element ' // side_text(crossing%face(1)) // ' passed through element ' // &
      side_text(crossing%face(2)) // ', and no contact keeps them apart there. '
    if (.not. is_nlgeom .and. displacement_span(model, u) > faces%least_width) then
      message = message // 'Without NLGEOM bodies touch only where they are near each other at the start: give NLGEOM on *STEP.'
    else if (any(is_thin(now%depth(crossing%face), now%edge_length(crossing%face)))) then
      message = message // 'The edge of a sheet of rigid elements touches nothing: make that body of solid elements with ' // &
        '*RIGID BODY, which have a depth.'
    else if (.not. model%general_contact%is_mortar) then
      message = message // 'Slave nodes touch what lies below them, not what lies between them: *CONTACT, TYPE=SURFACE TO ' // &
        'SURFACE looks at their faces.'
    else
      message = message // 'Faces that stand nearly upright on each other make no pair: name them in a *CONTACT PAIR.'
    end if
    message = message // ' Bodies that may pass each other are named in *CONTACT EXCLUSIONS.'

  contains

    !> A face in words.
    function side_text(f) result(text)
      integer, intent(in) :: f                     !< face
      character(:), allocatable :: text
      text = to_text(model%mesh%element_label(now%element(f))) // ' of ' // body_name(model, now, now%body(f))
    end function side_text

  end subroutine describe_crossing

end module amontons_unpaired_crossing
