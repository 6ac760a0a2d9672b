!> Proximity of exterior faces: which face each other within a distance, and the boxes of the search for them.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_face_proximity
  use amontons_kinds, only: DP
  use amontons_tensor, only: cross_product
  use amontons_exterior_surface, only: exterior_type, common_depth, reached_depth, is_thin, has_area
  use amontons_facets, only: facets_type
  use amontons_facet_search, only: facet_search_type, build_facet_search
  use amontons_mortar_segmentation, only: MIN_FACING_COSINE
  use amontons_contact_pairs, only: MAX_DEPTH_SHARE
  use amontons_rigid_exterior, only: compare_sheets, SHEETS_FACE, SHEETS_BEHIND, SHEETS_UNDECIDED
  implicit none
  private
  public :: are_near, compare_faces, box_distance, find_active_faces, list_facets, exterior_positions
  public :: build_face_search, is_larger

  real(DP), parameter :: MAX_LATERAL_OFFSET = 1.0_DP       !< of the centres of near faces, over the sum of their edges [-]
  real(DP), parameter :: BESIDE_DEPTH = 0.05_DP            !< faces may lie beside each other if behind by more, over an edge [-]
  real(DP), parameter :: TOL_BESIDE = 1.0e-6_DP            !< a smaller overlap is rounding, over an edge [-]

contains

  !> The faces with an area whose box, widened by a distance, meets the box of another body.
  subroutine find_active_faces(exterior, distance, is_active)
    type(exterior_type), intent(in) :: exterior
    real(DP), intent(in) :: distance               !< [length]
    logical, allocatable, intent(out) :: is_active(:)   !< (n)
    real(DP) :: box(3, 2, exterior%n_bodies)
    integer :: f, b
    box(:, 1, :) = huge(1.0_DP)
    box(:, 2, :) = -huge(1.0_DP)
    do f = 1, exterior%n
      b = exterior%body(f)
      box(:, 1, b) = min(box(:, 1, b), exterior%box(:, 1, f))
      box(:, 2, b) = max(box(:, 2, b), exterior%box(:, 2, f))
    end do
    allocate (is_active(exterior%n), source=.false.)
    do f = 1, exterior%n
      do b = 1, exterior%n_bodies
        if (b == exterior%body(f)) cycle
        is_active(f) = is_active(f) .or. box_distance(exterior%box(:, :, f), box(:, :, b)) <= distance
      end do
      is_active(f) = is_active(f) .and. has_area(exterior%n_corners(f), exterior%area(f), exterior%edge_length(f))
    end do
  end subroutine find_active_faces


  !> The distance between two boxes [length].
  pure real(DP) function box_distance(a, b) result(distance)
    real(DP), intent(in) :: a(3, 2), b(3, 2)       !< lower and upper corner [length]
    distance = norm2(max(0.0_DP, a(:, 1) - b(:, 2), b(:, 1) - a(:, 2)))
  end function box_distance


  !> Facets for the search: two nodes of each, which are numbered anew (`exterior_positions`).
  pure subroutine list_facets(n, facets)
    integer, intent(in) :: n                       !< faces
    type(facets_type), intent(out) :: facets
    integer :: i
    facets%n = n
    facets%first = [(2 * i - 1, i=1, facets%n + 1)]
    facets%nodes = [(i, i=1, 2 * facets%n)]
  end subroutine list_facets


  !> The corners of the boxes of some faces, as the positions of two nodes for each.
  pure function exterior_positions(exterior, faces) result(x)
    type(exterior_type), intent(in) :: exterior
    integer, intent(in) :: faces(:)
    real(DP) :: x(3, 2 * size(faces))              !< [length]
    x = reshape(exterior%box(:, :, faces), [3, 2 * size(faces)])
  end function exterior_positions


  !> The search for faces near smaller ones: at the centre of a face it finds every larger one (`is_larger`) whose box is within a
  !! distance of its own box. Small faces find large ones, so that a few large faces cost nothing among many small ones.
  subroutine build_face_search(exterior, faces, radius, distance, search)
    type(exterior_type), intent(in) :: exterior
    integer, intent(in) :: faces(:)                !< those to find; the search numbers them anew
    real(DP), intent(in) :: radius                 !< part of the distance over the edge of the larger face [-]
    real(DP), intent(in) :: distance               !< the other part [length]
    type(facet_search_type), intent(out) :: search
    type(facets_type) :: facets
    call list_facets(size(faces), facets)          ! a box of the smaller face reaches from its centre at most as far as its edge
    call build_facet_search(facets, exterior_positions(exterior, faces), distance, search, &
      own_margins=(radius + 1) * exterior%edge_length(faces))
  end subroutine build_face_search


  !> Whether a face is larger than another one, of equal ones the later one: of two faces one is.
  pure logical function is_larger(exterior, f, m)
    type(exterior_type), intent(in) :: exterior
    integer, intent(in) :: f, m                    !< faces
    is_larger = exterior%edge_length(f) > exterior%edge_length(m)
    if (.not. is_larger) is_larger = f > m .and. .not. exterior%edge_length(f) < exterior%edge_length(m)
  end function is_larger


  !> Whether two faces of different bodies are near each other.
  pure logical function are_near(exterior, f, m, radius, motion)
    type(exterior_type), intent(in) :: exterior
    integer, intent(in) :: f, m                    !< faces
    real(DP), intent(in) :: radius                 !< over the edge [-]
    real(DP), intent(in) :: motion                 !< [length]
    real(DP) :: between(3), lateral, front, cosine, depth, height
    are_near = .false.
    cosine = dot_product(exterior%normal(:, f), exterior%normal(:, m))
    if (cosine > -MIN_FACING_COSINE) return
    height = exterior%height(f) + exterior%height(m)
    if (box_distance(exterior%box(:, :, f), exterior%box(:, :, m)) > motion + max(0.0_DP, height) + radius &
      * max(exterior%edge_length(f), exterior%edge_length(m))) return
    between = exterior%centre(:, m) - exterior%centre(:, f)
    front = min(dot_product(between, exterior%normal(:, f)), -dot_product(between, exterior%normal(:, m)))
    lateral = norm2(between - dot_product(between, exterior%normal(:, f)) * exterior%normal(:, f))
    if (lateral > MAX_LATERAL_OFFSET * (exterior%edge_length(f) + exterior%edge_length(m)) + motion) return
    if (all(is_thin(exterior%depth([f, m]), exterior%edge_length([f, m])))) then
      are_near = compare_faces(exterior, f, m) /= SHEETS_BEHIND
      return
    end if
    if (cosine > -0.5_DP) front = front + lateral * sqrt(1 - cosine**2)   ! inclined: the centres do not show which is in front
    depth = min(common_depth(face_depth(f, m), exterior%edge_length(f), exterior%thickness(m)), &
      common_depth(face_depth(m, f), exterior%edge_length(m), exterior%thickness(f)))
    are_near = front >= min(0.0_DP, height) - MAX_DEPTH_SHARE * depth - motion
    if (are_near .and. front < min(0.0_DP, height) - BESIDE_DEPTH * minval(exterior%edge_length([f, m])) - motion) are_near = &
      .not. are_beside(exterior, f, m)

  contains

    !> How deep another face may lie behind a face [length].
    pure real(DP) function face_depth(own, other)
      integer, intent(in) :: own, other            !< faces
      face_depth = reached_depth(exterior%depth(own), exterior%thickness(own), exterior%edge_length(other))
    end function face_depth

  end function are_near


  !> Whether two faces, seen along the normal of one, lie beside each other and share an edge at most, as the side faces of two
  !! bodies in a stack. Method: a line along an edge of one separates them.
  pure logical function are_beside(exterior, f, m)
    type(exterior_type), intent(in) :: exterior
    integer, intent(in) :: f, m                    !< faces
    are_beside = is_separated(f, m)
    if (.not. are_beside) are_beside = is_separated(m, f)

  contains

    !> Whether a line along an edge of a face separates it from another one.
    pure logical function is_separated(own, other)
      integer, intent(in) :: own, other            !< faces
      real(DP) :: edge(3), across(3)               ! unit vectors
      integer :: k, n
      is_separated = .false.
      n = exterior%n_corners(own)
      associate (x => exterior%x(:, exterior%nodes(exterior%first(own):exterior%first(own) + n - 1)), &
        y => exterior%x(:, exterior%nodes(exterior%first(other):exterior%first(other) + exterior%n_corners(other) - 1)))
        do k = 1, n
          edge = x(:, modulo(k, n) + 1) - x(:, k)
          if (norm2(edge) <= 0.0_DP) cycle         ! collapsed
          across = edge
          if (n > 2) across = cross_product(exterior%normal(:, own), edge)
          across = across / norm2(across)
          is_separated = min(maxval(matmul(across, x)), maxval(matmul(across, y))) - max(minval(matmul(across, x)), &
            minval(matmul(across, y))) <= TOL_BESIDE * min(exterior%edge_length(own), exterior%edge_length(other))
          if (is_separated) return
        end do
      end associate
    end function is_separated

  end function are_beside


  !> Whether two faces without depth face each other (`compare_sheets`); faces of bodies with a depth do. Faces apart, each of which
  !! reaches through the plane of the other, do not.
  pure integer function compare_faces(exterior, f, m) result(order)
    type(exterior_type), intent(in) :: exterior
    integer, intent(in) :: f, m                    !< faces
    order = SHEETS_FACE
    if (.not. all(is_thin(exterior%depth([f, m]), exterior%edge_length([f, m])))) return
    associate (first => exterior%first([f, m]), last => exterior%first([f, m]) + exterior%n_corners([f, m]) - 1)
      order = compare_sheets(exterior%x(:, exterior%nodes(first(1):last(1))), exterior%x(:, exterior%nodes(first(2):last(2))), &
        exterior%normal(:, [f, m]), sum(exterior%depth([f, m])))
    end associate
    if (order == SHEETS_UNDECIDED .and. box_distance(exterior%box(:, :, f), exterior%box(:, :, m)) > &
      sum(exterior%depth([f, m]))) order = SHEETS_BEHIND
  end function compare_faces

end module amontons_face_proximity
